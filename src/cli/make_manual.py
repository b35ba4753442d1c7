#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the man pages and the completion of shells from what the program says of itself.

usage: make_manual.py PROGRAM FOLDER

Asks PROGRAM for its commands (--help) and for the manual of each (--help-all where the command knows it, else --help),
and writes below FOLDER, as below the share/ of an installation: man/man1/pliant*.1,
bash-completion/completions/pliant, zsh/site-functions/_pliant and fish/vendor_completions.d/pliant.fish.
"""

import datetime
import os
import pathlib
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass, field

PATHS = {"PATH": "path", "path": "path", "FILE": "path", "DIR": "folder"}
HELP = "print the manual of a command"  # pliant help COMMAND, which has no manual of its own


@dataclass
class Option:
    """--name VALUE. `kind`: flag (no value), path, folder, choice, list (choices with commas), or value (any)."""
    name: str
    text: str
    shown: str  # as the manual shows it, with its values
    kind: str = "value"
    choices: list = field(default_factory=list)
    short: str = ""
    several: bool = False
    positional: bool = False


@dataclass
class Command:
    words: list  # ["dataset", "info"]
    summary: str
    sections: dict = field(default_factory=dict)  # title: lines, without their indentation
    arguments: list = field(default_factory=list)
    groups: list = field(default_factory=list)  # (title, options)
    verbs: list = field(default_factory=list)

    def options(self):
        return self.arguments + [option for _, options in self.groups for option in options]


def ask(program, *words):
    """What the program prints, or None where it does not take these words."""
    run = subprocess.run([program, *words], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    return run.stdout if run.returncode == 0 else None


def joined(lines):
    return " ".join(line.strip() for line in lines if line.strip())


def paragraphs(lines):
    return [joined(part.split("\n")) for part in "\n".join(lines).split("\n\n") if part.strip()]


def split_entries(lines, indent):
    """(first line, text) of each entry: its first line is indented by `indent`, its text further."""
    entries = []
    for line in lines:
        if line.strip() and len(line) - len(line.lstrip()) == indent:
            entries.append((line.strip(), []))
        elif line.strip() and entries:
            entries[-1][1].append(line)
    return [(first, joined(text)) for first, text in entries]


def read_values(option, values):
    """What the manual says of an option's values: "paper|depth", "off | on", "one, two, several with commas, or all"."""
    if "several with commas" in values:
        option.kind = "list"
        option.choices = [name.removeprefix("or ") for name in values.split(", ") if name != "several with commas"]
    elif "|" in values:
        option.kind = "list" if "several with commas" in option.text else "choice"
        option.choices = [name.strip() for name in values.split("|")]
    elif values == "bool":
        option.kind, option.choices = "choice", ["true", "false"]
    else:
        option.kind = PATHS.get(values, "value")
    return option


def read_argument(first, text):
    """An entry of ARGUMENTS: "-o, --output_path DIR", "[--run] DIR", "[--run] DIR ...", "--video FILE [--video ...]" or
    "--quiet"."""
    match = re.fullmatch(r"(?:-(\w), )?(\[)?--([\w-]+)\]?(?: (?!\[)(\S+))?( \[--.* \.\.\.\]| \.\.\.)?", first)
    if match is None:
        sys.exit(f"make_manual.py: there is an argument that it cannot read: {first!r}")
    short, positional, name, values, several = match.groups()
    option = Option("--" + name, text, first, short=short or "", several=bool(several), positional=bool(positional))
    if values is None:
        option.kind = "flag"
        return option
    return read_values(option, values)


def read_option(first, text):
    """An entry of OPTIONS: "--Group.option default  [unit or choices]"."""
    match = re.fullmatch(r"--(\S+) .*?  \[(.*)\]", first)
    if match is None:
        sys.exit(f"make_manual.py: there is an option that it cannot read: {first!r}")
    return read_values(Option("--" + match[1], text, first), match[2])


def read_groups(lines):
    groups = []
    for part in "\n".join(lines).split("\n\n"):
        lines = part.split("\n")
        entries = [read_option(*entry) for entry in split_entries(lines, 4)]
        if entries:
            head = next(i for i, line in enumerate(lines) if line.startswith("    --"))
            groups.append((joined(lines[:head]), entries))
    return groups


def read_command(program, words, summary):
    text = ask(program, *words, "--help-all") or ask(program, *words, "--help")
    if text is None:
        sys.exit(f"make_manual.py: 'pliant {' '.join(words)}' prints no manual")
    command = Command(words, summary)
    if text.startswith("usage:"):
        verbs = re.findall(rf"^(?:usage:|      ) pliant {' '.join(words)} ([a-z]\S*)", text, re.MULTILINE)
        command.verbs = [read_command(program, [*words, verb], "") for verb in verbs]
        return command
    head, *rest = re.split(r"^([A-Z][A-Z ]+)\n", text, flags=re.MULTILINE)
    command.summary = head.strip().partition(" - ")[2]
    for title, body in zip(rest[::2], rest[1::2]):
        command.sections[title] = body.rstrip("\n").split("\n")
    command.arguments = [read_argument(*entry) for entry in split_entries(command.sections.get("ARGUMENTS", []), 2)]
    command.groups = read_groups(command.sections.get("OPTIONS", []))
    return command


def read_program(program):
    text = ask(program, "--help")
    title = text.split("\n")[0].partition(" - ")[2]
    commands = [read_command(program, [name], summary)
                for name, summary in re.findall(r"^  ([a-z][\w-]*) {2,}(\S.*)$", text, re.MULTILINE)]
    return title, commands


def with_verbs(commands):
    """The commands that have a manual: of dataset its verbs."""
    return [leaf for command in commands for leaf in (command.verbs or [command])]


# Man pages.

ROFF = {"\\": r"\e", "-": r"\-", "'": r"\(aq", "`": r"\(ga", "^": r"\(ha", "~": r"\(ti"}


def roff(text):
    escaped = "".join(ROFF.get(character, character) for character in text)
    return r"\&" + escaped if escaped.startswith(".") else escaped


def styled(usage):
    """Names of programs and options bold, placeholders italic."""
    def style(match):
        word = match.group()
        return (r"\fI" if word[0].isupper() else r"\fB") + roff(word) + r"\fR"
    pieces = re.split(r"(--?[A-Za-z][\w.-]*|\b[A-Z][A-Z]+\b|\bVALUE\b)", usage)
    return "".join(re.sub(r".+", style, piece) if i % 2 else roff(piece) for i, piece in enumerate(pieces))


def page_head(name, summary, version):
    seconds = int(os.environ.get("SOURCE_DATE_EPOCH", datetime.datetime.now().timestamp()))
    date = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc).strftime("%Y-%m-%d")
    return [f'.TH {name.upper()} 1 {date} "Pliant {version}" "User Commands"', ".nh", ".ad l", ".SH NAME",
            f"{name} \\- {roff(summary)}"]


def shown_option(option):
    """The tag of an option: its name bold, its default and choices as they are."""
    name, space, values = option.shown.partition(option.name + " ")
    if not space:
        return styled(option.shown)
    values = roff(values) if "." in option.name else styled(values).replace("|", r"|\:")
    return styled(name + option.name) + " " + values


def entries(options):
    return [line for option in options for line in (".TP", shown_option(option), roff(option.text) or r"\&")]


def see_also(pages, own):
    others = [page for page in pages if page != own]
    return [".SH SEE ALSO"] + [f".BR {page} (1){',' if page != others[-1] else ''}" for page in others]


def page_name(command):
    return "-".join(["pliant", *command.words])


def command_page(command, version, pages):
    lines = page_head(page_name(command), command.summary, version)
    for title, body in command.sections.items():
        lines.append(".SH " + {"USAGE": "SYNOPSIS", "EXIT CODES": "EXIT STATUS"}.get(title, title))
        if title == "USAGE":
            lines.append(styled(joined(body)).replace("pliant " + " ".join(command.words),
                                                      rf"\fBpliant {' '.join(command.words)}\fR", 1))
        elif title == "ARGUMENTS":
            lines += entries(command.arguments)
        elif title == "OPTIONS":
            lines.append(roff(paragraphs(body)[0]))
            for group, options in command.groups:
                lines += [f'.SS "{roff(group)}"'.replace('""', '"'), *entries(options)]
        elif title == "EXIT CODES":
            for line in body:
                code, _, text = line.strip().partition("  ")
                lines += [".TP", rf"\fB{code}\fR", roff(text)] if code else []
        elif title == "EXAMPLES":
            lines += [".nf", *[roff(line.strip()) for line in body if line.strip()], ".fi"]
        else:
            lines += [line for i, text in enumerate(paragraphs(body)) for line in ([".PP"] if i else []) + [roff(text)]]
    return lines + see_also(pages, page_name(command))


def overview_page(title, commands, version, pages):
    lines = page_head("pliant", title, version)
    lines += [".SH SYNOPSIS", r"\fBpliant\fR \fICOMMAND\fR ...", ".br", r"\fBpliant \-\-version\fR",
              ".SH DESCRIPTION",
              "Each command has a manual page of its own, which the command prints too when it is given "
              r"\fB\-\-help\fR.", ".SH COMMANDS"]
    for command in commands:
        lines += [".TP", rf"\fB{roff(' '.join(command.words))}\fR", roff(command.summary)]
    lines += [".TP", r"\fBhelp\fR \fICOMMAND\fR", HELP]
    return lines + see_also(pages, "pliant")


def man_pages(title, commands, version):
    """(file name, text) of each page."""
    leaves = with_verbs(commands)
    pages = ["pliant", *[page_name(command) for command in leaves]]
    yield "pliant.1", overview_page(title, commands, version, pages)
    for command in leaves:
        yield page_name(command) + ".1", command_page(command, version, pages)


# Completion. Bash is told of an option "PATH", "FOLDER", "FLAG", "LIST a b" or "a b"; what is not told takes any value.

def told(option):
    return {"path": "PATH", "folder": "FOLDER", "flag": "FLAG", "value": "", "choice": " ".join(option.choices),
            "list": " ".join(["LIST", *option.choices])}[option.kind]


def names(option):
    return [option.name] + (["-" + option.short] if option.short else [])


BASH_HEAD = """\
# bash completion of pliant, made by make_manual.py from the program's own manual.

# The words that may follow a command: its verbs, or its options.
_pliant_words() {
  case $1 in
"""

BASH_MIDDLE = """\
  esac
}

# What an option of a command takes; behind "command -" what it takes without an option's name.
_pliant_values() {
  case $1 in
"""

BASH_TAIL = """\
  esac
}

_pliant() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]} first=2 option=
  local values words
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "$(_pliant_words '')" -- "$current")
    return
  fi
  if [[ $command == help ]] && ((COMP_CWORD > 3)); then return; fi
  # Of a command with verbs, the verb belongs to its name.
  if [[ $(_pliant_words "$command") != -* ]]; then
    if ((COMP_CWORD > 2)); then command+=" ${COMP_WORDS[2]}"; fi
    first=3
  fi
  # Bash takes --name=value for three words.
  if [[ $current == = ]]; then
    current='' option=$before
  elif [[ $before == = ]]; then
    option=${COMP_WORDS[COMP_CWORD - 2]}
  elif ((COMP_CWORD > first)) && [[ $before == -* ]]; then
    option=$before
  fi
  if [[ -n $option ]]; then values=$(_pliant_values "$command $option"); fi
  if [[ -z $option || $values == FLAG ]]; then
    values=$(_pliant_values "$command -")
    if [[ -z $values || $current == -* ]]; then
      words=$(_pliant_words "$command")
      # There are hundreds of options: their groups first.
      if [[ $current != *.* ]]; then words=$(sed -E 's/^(--[^.]*\\.).*/\\1/' <<<"$words" | uniq); fi
      mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
      if [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *. ]]; then compopt -o nospace; fi
      return
    fi
  fi
  case $values in
    PATH) compopt -o filenames; mapfile -t COMPREPLY < <(compgen -f -- "$current") ;;
    FOLDER) compopt -o filenames; mapfile -t COMPREPLY < <(compgen -d -- "$current") ;;
    LIST*)
      local done=''
      if [[ $current == *,* ]]; then done=${current%,*},; fi
      mapfile -t COMPREPLY < <(compgen -P "$done" -W "${values#LIST}" -- "${current##*,}")
      ;;
    *) mapfile -t COMPREPLY < <(compgen -W "$values" -- "$current") ;;
  esac
}
complete -F _pliant pliant
"""


def bash_completion(commands):
    first = [command.words[0] for command in commands]
    words = {"": [*first, "help", "--help", "--version"], "help": first}
    values = {}
    for command in commands:
        if command.verbs:
            words[command.words[0]] = words["help " + command.words[0]] = [verb.words[-1] for verb in command.verbs]
    for command in with_verbs(commands):
        key = " ".join(command.words)
        words[key] = [name for option in command.options() for name in names(option)]
        for option in command.options():
            for name in names(option) + (["-"] if option.positional else []):
                if told(option):
                    values.setdefault(told(option), []).append(f"{key} {name}")
    text = BASH_HEAD
    for key, known in words.items():
        text += f"    '{key}') echo '" + "\n".join(known) + "' ;;\n"
    text += BASH_MIDDLE
    for value, keys in values.items():
        text += "    " + " | \\\n      ".join(f"'{key}'" for key in keys) + f")\n      echo '{value}' ;;\n"
    return text + BASH_TAIL


def short_text(text):
    """The beginning of a sentence, for a list of options."""
    text = re.split(r"[;:(]", text)[0].strip()
    return text if len(text) <= 70 else text[:70].rsplit(" ", 1)[0] + " ..."


def zsh_text(text):
    return re.sub(r"([\[\]:\\])", r"\\\1", short_text(text))


def zsh_action(option):
    return {"path": "_files", "folder": "_files -/", "value": " ", "choice": "(" + " ".join(option.choices) + ")",
            "list": "_sequence compadd - " + " ".join(option.choices)}[option.kind]


def zsh_specs(command):
    for option in command.options():
        for name in names(option):
            end = "" if option.kind == "flag" else f":{option.kind}:{zsh_action(option)}"
            repeat = "*" if option.several else ""
            equals = "" if option.kind == "flag" else "=" if name.startswith("--") else "+"
            yield shlex.quote(f"{repeat}{name}{equals}[{zsh_text(option.text)}]{end}")
        if option.positional:
            place = "*" if option.several else "1"
            yield shlex.quote(f"{place}:{option.kind}:{zsh_action(option)}")


def zsh_command(command, indent):
    specs = (" \\\n" + indent + "    ").join(zsh_specs(command))
    return f"{indent}{command.words[-1]})\n{indent}  _arguments \\\n{indent}    {specs}\n{indent}  ;;\n"


def zsh_description(word, summary):
    return shlex.quote(word + ":" + summary)


def zsh_completion(commands):
    text = ("#compdef pliant\n# zsh completion of pliant, made by make_manual.py from the program's own manual.\n\n"
            "local curcontext=$curcontext state line\nlocal -a known\n"
            "_arguments -C '--help[list the commands]' '--version[print the version]' '1:command:->command' "
            "'*::argument:->argument'\ncase $state in\n  command)\n    known=(\n")
    text += "".join(f"      {zsh_description(command.words[0], command.summary)}\n" for command in commands)
    text += f"      {zsh_description('help', HELP)}\n"
    text += "    )\n    _describe command known\n    ;;\n  argument)\n    case $words[1] in\n"
    text += (f"      help)\n        _arguments '1:command:({' '.join(command.words[0] for command in commands)})' "
             "'2:verb:->verb'\n        if [[ $state == verb ]]; then\n          case $words[2] in\n")
    text += "".join(f"            {command.words[0]}) compadd {' '.join(verb.words[-1] for verb in command.verbs)} ;;\n"
                    for command in commands if command.verbs)
    text += "          esac\n        fi\n        ;;\n"
    for command in commands:
        if not command.verbs:
            text += zsh_command(command, "      ")
            continue
        text += (f"      {command.words[0]})\n        _arguments -C '1:verb:->verb' '*::argument:->argument'\n"
                 "        case $state in\n          verb)\n            known=(\n")
        text += "".join(f"              {zsh_description(verb.words[-1], verb.summary)}\n" for verb in command.verbs)
        text += ("            )\n            _describe verb known\n            ;;\n          argument)\n"
                 "            case $words[1] in\n")
        text += "".join(zsh_command(verb, "              ") for verb in command.verbs)
        text += "            esac\n            ;;\n        esac\n        ;;\n"
    return text + "    esac\n    ;;\nesac\n"


def fish_option(command, option):
    seen = "; and ".join(f"__fish_seen_subcommand_from {word}" for word in command.words)
    takes = {"path": "-r -F", "folder": "-x -a '(__fish_complete_directories)'", "flag": "", "value": "-x",
             "choice": "-x -a " + shlex.quote(" ".join(option.choices)),
             "list": "-x -a " + shlex.quote(" ".join(option.choices))}[option.kind]
    short = f"-s {option.short} " if option.short else ""
    return f"complete -c pliant -n '{seen}' {short}-l {option.name[2:]} {takes} -d {fish_quote(short_text(option.text))}\n"


def fish_quote(text):
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def fish_completion(commands):
    text = "# fish completion of pliant, made by make_manual.py from the program's own manual.\n\ncomplete -c pliant -f\n"
    every = " ".join(command.words[0] for command in commands)
    text += (f"complete -c pliant -n __fish_use_subcommand -a help -d {fish_quote(HELP)}\n"
             f"complete -c pliant -n '__fish_seen_subcommand_from help; and not __fish_seen_subcommand_from {every}' "
             f"-a '{every}'\n")
    for command in commands:
        text += (f"complete -c pliant -n __fish_use_subcommand -a {command.words[0]} "
                 f"-d {fish_quote(command.summary)}\n")
        verbs = " ".join(verb.words[-1] for verb in command.verbs)
        for verb in command.verbs:
            text += (f"complete -c pliant -n '__fish_seen_subcommand_from {command.words[0]}; and not "
                     f"__fish_seen_subcommand_from {verbs}' -a {verb.words[-1]} -d {fish_quote(verb.summary)}\n")
    for command in with_verbs(commands):
        text += "".join(fish_option(command, option) for option in command.options())
        for option in command.options():
            if option.positional:
                seen = "; and ".join(f"__fish_seen_subcommand_from {word}" for word in command.words)
                folders = " -a '(__fish_complete_directories)'" if option.kind == "folder" else " -F"
                text += f"complete -c pliant -n '{seen}'{folders}\n"
    return text


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    title, commands = read_program(program)
    version = ask(program, "--version").split()[1]
    for name, lines in man_pages(title, commands, version):
        write(folder / "man" / "man1" / name, "\n".join(lines) + "\n")
    write(folder / "bash-completion" / "completions" / "pliant", bash_completion(commands))
    write(folder / "zsh" / "site-functions" / "_pliant", zsh_completion(commands))
    write(folder / "fish" / "vendor_completions.d" / "pliant.fish", fish_completion(commands))


if __name__ == "__main__":
    main()
