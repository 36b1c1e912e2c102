// A client of the Foxglove WebSocket protocol that comes back by itself.

const PROTOCOL = "foxglove.websocket.v1";
const MESSAGE_DATA = 1, CALL_REQUEST = 2, CALL_RESPONSE = 3;
const FIRST_WAIT_MS = 500, LONGEST_WAIT_MS = 8000, ANSWER_WAIT_MS = 20000;

const decoder = new TextDecoder();
const encoder = new TextEncoder();

export class Client extends EventTarget {
  // topics: which are to be subscribed to, of those that are advertised.
  // Events: "open", "services" (names), "message" (topic, data), "close" (waitMs), "unauthorized".
  constructor(topics) {
    super();
    this.topics = topics;
    this.token = "";
    this.waitMs = FIRST_WAIT_MS;
    this.forget();
  }

  forget() {
    this.subscriptions = new Map();  // our id: topic
    this.services = new Map();       // name: id
    for (const call of (this.calls ?? new Map()).values()) call.reject(new Error("the connection was lost"));
    this.calls = new Map();          // number: {resolve, reject}
    this.nextCall = 1;
  }

  connect() {
    clearTimeout(this.timer);
    const query = this.token ? "?token=" + encodeURIComponent(this.token) : "";
    const secure = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(`${secure}//${location.host}/${query}`, PROTOCOL);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { this.waitMs = FIRST_WAIT_MS; this.say("open"); };
    socket.onmessage = event => typeof event.data === "string" ? this.takeText(event.data) : this.takeBinary(event.data);
    socket.onclose = () => { if (socket === this.socket) this.lost(); };
  }

  say(type, detail) { this.dispatchEvent(new CustomEvent(type, {detail})); }

  // A WebSocket does not tell why it was refused; a plain request does.
  async lost() {
    this.forget();
    const headers = this.token ? {Authorization: "Bearer " + this.token} : {};
    const answer = await fetch("/metrics", {method: "HEAD", headers}).catch(() => null);
    if (answer?.status === 401) { this.say("unauthorized"); return; }
    this.say("close", this.waitMs);
    this.timer = setTimeout(() => this.connect(), this.waitMs);
    this.waitMs = Math.min(2 * this.waitMs, LONGEST_WAIT_MS);
  }

  takeText(text) {
    const message = JSON.parse(text);
    switch (message.op) {
      case "advertise": this.subscribe(message.channels); break;
      case "advertiseServices":
        for (const service of message.services) this.services.set(service.name, service.id);
        this.say("services", [...this.services.keys()]);
        break;
      case "serviceCallFailure":
        this.calls.get(message.callId)?.reject(new Error(message.message));
        this.calls.delete(message.callId);
        break;
      case "status": console.warn("view:", message.message); break;
    }
  }

  subscribe(channels) {
    const subscriptions = [];
    for (const channel of channels) {
      if (!this.topics.includes(channel.topic) || channel.encoding !== "json") continue;
      this.subscriptions.set(channel.id, channel.topic);
      subscriptions.push({id: channel.id, channelId: channel.id});
    }
    this.socket.send(JSON.stringify({op: "subscribe", subscriptions}));
  }

  takeBinary(buffer) {
    const view = new DataView(buffer);
    switch (view.getUint8(0)) {
      case MESSAGE_DATA: {
        const topic = this.subscriptions.get(view.getUint32(1, true));
        if (topic) this.say("message", {topic, data: JSON.parse(decoder.decode(new Uint8Array(buffer, 13)))});
        break;
      }
      case CALL_RESPONSE: {
        const number = view.getUint32(5, true), length = view.getUint32(9, true);
        this.calls.get(number)?.resolve(JSON.parse(decoder.decode(new Uint8Array(buffer, 13 + length))));
        this.calls.delete(number);
        break;
      }
    }
  }

  // What the service answers: {ok, error}.
  call(name, request) {
    const service = this.services.get(name);
    if (service === undefined || this.socket.readyState !== WebSocket.OPEN) return Promise.reject(new Error("not connected"));
    const encoding = encoder.encode("json"), data = encoder.encode(JSON.stringify(request));
    const bytes = new Uint8Array(13 + encoding.length + data.length), view = new DataView(bytes.buffer);
    const number = this.nextCall++;
    view.setUint8(0, CALL_REQUEST);
    view.setUint32(1, service, true);
    view.setUint32(5, number, true);
    view.setUint32(9, encoding.length, true);
    bytes.set(encoding, 13);
    bytes.set(data, 13 + encoding.length);
    return new Promise((resolve, reject) => {
      this.calls.set(number, {resolve, reject});
      setTimeout(() => { if (this.calls.delete(number)) reject(new Error("no answer")); }, ANSWER_WAIT_MS);
      this.socket.send(bytes);
    });
  }
}
