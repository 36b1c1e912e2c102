# bash completion for crspf(1). Asks the program, so that it never says anything else than --help does.

_crspf() {
    local current=${COMP_WORDS[COMP_CWORD]} word words=() help
    for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
        [[ $word == [a-z]* && ${#words[@]} -lt 2 ]] || break  # sub-commands stand first
        words+=("$word")
    done
    help=$(crspf "${words[@]}" --help 2>/dev/null) || help=$(crspf "${words[0]}" --help 2>/dev/null) || return
    if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(grep -oE '(^ +|,)--?[a-z][a-z-]*' <<<"$help" | tr -d ' ,')" -- "$current")
    elif [[ $help == *Subcommands:* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(sed -n '/^Subcommands:/,$s/^  \([a-z-]\+\) .*/\1/p' <<<"$help")" -- "$current")
    elif [[ ${words[0]:-} == experiments && ${COMP_WORDS[COMP_CWORD-1]} != -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(crspf experiments --list | cut -d ' ' -f 1)" -- "$current")
    fi  # else a file
}
complete -o default -F _crspf crspf
