# To be sourced.
# free_port SOCK_STREAM|SOCK_DGRAM: a port of the loopback that nobody has.
free_port() {
    python3 -c 'import socket, sys
s = socket.socket(type=getattr(socket, sys.argv[1]))
s.bind(("127.0.0.1", 0))
print(s.getsockname()[1])' "$1"
}
