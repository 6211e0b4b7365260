"""completion.py ORTHANT: completions in bash, zsh and fish, each asked as a user would.

bash: its function is called with the words of a line. zsh: a shell of its own in a terminal, to which the line and a
tab are typed.
fish: `complete -C LINE`. A shell that is not installed is named, and skipped.
"""

import os
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ORTHANT = str(Path(sys.argv[1]).resolve())

# What is typed behind "orthant ", and the one word that its last word becomes; None: no word of ours, or several.
LINES = {
    "sim": "simulate",
    "--max": "--max-input",
    "--max-input 8GiB sol": "solve",
    "--plugin mine.so --max-input 1GiB sol": "solve",
    "--plugin mine.so check --json benn": "bennett",
    "simulate benn": "bennett",
    "simulate --step 1e-3 --json benn": "bennett",
    "simulate --solver lemke-h": "lemke-howson",
    "simulate --solver lemke slider_crank_s": "slider_crank_space",
    "simulate bennett --solver lemke-h": "lemke-howson",
    "simulate --json --integrator stew": "stewart-trinkle",
    "simulate slider_crank --integ": "--integrator",
    "simulate bennett ben": None,  # there is one scene
    "simulate --step ben": None,  # a value
    "solve --json --err": "--error-bound",
    "view --serve 80 euler_d": "euler_disc",
    "view run.csv --scene euler_d": "euler_disc",
    "list sc": "scenes",
    "schema --json sim": "simulate",
    "man --json sim": "simulate",
    "man simulate --ste": None,  # an option of another command
    "new m": "mechanism",
    "completion z": "zsh",
    "check FILE-": "FILE-HERE.toml",
}


def bash(folder, line):
    words = " ".join(f"'{word}'" for word in line.split())
    code = (f"source <({ORTHANT} completion); COMP_WORDS=(orthant {words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); "
            "_orthant; echo ${COMPREPLY[@]}")
    found = subprocess.run(["bash", "-c", code], capture_output=True, text=True, check=True, cwd=folder).stdout.split()
    if not found:  # files, as `complete -o default` has them
        last = line.split()[-1]
        found = [name for name in os.listdir(folder) if name.startswith(last)]
    return found[0] if len(found) == 1 else None


def fish(folder, line):
    code = f"{ORTHANT} completion fish | source; complete -C 'orthant {line}'"
    said = subprocess.run(["fish", "--no-config", "-c", code], capture_output=True, text=True, check=True, cwd=folder,
                          env={**os.environ, "HOME": str(folder)})
    assert said.stderr == "", said.stderr
    found = [row.split("\t")[0] for row in said.stdout.splitlines()]
    return found[0] if len(found) == 1 else None


class Zsh:
    """An interactive zsh without anybody's settings; control-x prints the line as it stands."""

    SET_UP = """PROMPT='' RPROMPT='' ; autoload -U compinit && compinit -u -D
show() { print -r -- "<line>$BUFFER</line>" }; zle -N show; bindkey '^X' show
zstyle ':completion:*' menu no; setopt no_auto_menu no_list_beep no_beep
"""

    def __init__(self, folder):
        self.process, self.terminal = pty.fork()
        if self.process == 0:
            os.chdir(folder)
            os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, "HOME": str(folder), "TERM": "dumb"})
        self.said = ""
        self.type(self.SET_UP + f"source <({ORTHANT} completion zsh); print rea''dy\n")
        self.wait(r"ready\r?\n")

    def type(self, text):
        os.write(self.terminal, text.encode())

    def wait(self, pattern, seconds=20):
        end = time.monotonic() + seconds
        while not (match := re.search(pattern, self.said)):
            if not select.select([self.terminal], [], [], max(0, end - time.monotonic()))[0]:
                raise TimeoutError(f"zsh said {self.said!r}")
            self.said += os.read(self.terminal, 65536).decode(errors="replace")
        self.said = ""
        return match

    def complete(self, line):
        self.type(f"\x15orthant {line}\t\x18")
        after = self.wait(r"<line>(.*?)</line>")[1]
        assert after.startswith("orthant "), after
        return after.split()[-1] if after.endswith(" ") else None


def main():
    wrong = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "FILE-HERE.toml").write_text("")
        for shell in ("bash", "zsh", "fish"):
            if shutil.which(shell) is None:
                print(f"{shell}: not installed, its completions are not tried")
                continue
            zsh = Zsh(folder) if shell == "zsh" else None
            for line, expected in LINES.items():
                found = zsh.complete(line) if zsh else {"bash": bash, "fish": fish}[shell](folder, line)
                if found != expected:
                    wrong.append(f"{shell}: orthant {line}: {found}, not {expected}")
            print(f"{shell}: {len(LINES)} lines")
    sys.exit("\n".join(wrong) or 0)


main()
