"""Is the article's every number computed? Fails, naming file and line, when

  a number is typed by hand   digits in the text, names in \\code{} included; in a formula two digits, a decimal, a
                              digit before a unit, a digit alone, one above 1 after a relation (any other single digit
                              there is structure); a number in words, but for those of STRUCTURE
  a key \\R{…} or a generated file is not there, or one that is there is not used
  generated/ is not what tables.py makes of data/
  a study has been changed since data/ was computed   (its sweep file is another one, or its line in paper/results)
  a citation is not in references.bib, or an entry is not cited
Needs Python only. With a folder as argument that is the paper/ to look at.
"""
import json
import re
import sys
from pathlib import Path

PAPER = Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else Path(__file__).resolve().parents[1]
sys.path.insert(0, str(PAPER / "scripts"))
from tables import files  # noqa: E402
from reduce import STUDIES, fingerprint  # noqa: E402

# Commands whose arguments are names, not text; and lengths and column widths.
NAMES = re.compile(
    r"\\(?:R|input|ref|eqref|label|includegraphics|begin|end|citep|citet|cite|bibliography|bibliographystyle|"
    r"vspace|hspace|setlength)\*?(?:\[[^\]]*\])*(?:\{[^{}]*\})+")
CODE = re.compile(r"\\code\{[^{}]*\}")
WORDS = re.compile(
    r"\b(?:three|four|five|six|seven|eight|nine|ten|eleven|twelve|\w+teen|"
    r"(?:twenty|thirty|forty|fifty|sixty|seventy|eighty|ninety)(?:-\w+)?|dozens?|"
    r"hundred\w*|thousand\w*|million\w*|billion\w*|"
    r"(?:four|fif|six|seven|eigh|nin|ten|eleven|twelf|\w+teen|\w+tie)ths?|half|thirds?|quarters?|"
    r"two (?:of|values|runs|scenes|starts|schemes|solvers|where))\b", re.I)
# Numbers in words that no run could change: parts of the mechanism, of a formula, of the text itself; names of errors
# in a table.
STRUCTURE = ("ask five questions", "Three findings stand out", "The contribution is threefold",
             "four corners, two walls", "three degrees of freedom", "has three rows a contact", "fall into four kinds",
             "Third, started tilted", "four-bar", "each digit costs ten times the work", "a hundredth of a radian",
             "A thousandth takes", "reaches a millionth", "at most half the time", "a thousand-millionth",
             "hundreds of contacts", "Two schemes satisfy", "two runs of a study", "has two starts")
MATHS = re.compile(r"\$.+?\$|\\begin\{(equation|align|gather)\*?\}.*?\\end\{\1\*?\}|\\\[.*?\\\]", re.S)


def blank(match):
    return re.sub(r"[^\n]", " ", match.group(0))  # lines stay where they are


def hand_typed(text):
    """(line, what) of every number that no script has written."""
    text = re.sub(r"(?<!\\)%.*", "", text)
    maths = [(m.start(), m.group(0)) for m in MATHS.finditer(text)]
    for start, formula in maths:
        plain = NAMES.sub(blank, formula)
        for m in re.finditer(
            r"\d*\.\d+|\d{2,}|\d(?=\\,\\mathrm)|(?<=^\$)\d(?=\$$)|(?<=[=<>])\s*[2-9]|"
            r"(?:\\(?:le|ge|approx|sim)\b\s*)[2-9]",
            plain,
        ):
            yield text.count("\n", 0, start + m.start()) + 1, m.group(0).strip()
    words = NAMES.sub(blank, MATHS.sub(blank, text))
    for m in re.finditer(r"\d[\d.,]*", words):
        yield text.count("\n", 0, m.start()) + 1, m.group(0)
    words = CODE.sub(blank, words)
    for phrase in STRUCTURE:
        words = re.sub(r"\s+".join(map(re.escape, phrase.split())), blank, words)
    for m in WORDS.finditer(words):
        yield text.count("\n", 0, m.start()) + 1, f"'{m.group(0)}'"


def problems():
    sources = [PAPER / "paper.tex", *sorted((PAPER / "sections").glob("*.tex"))]
    texts = {path: path.read_text() for path in sources}
    for path, text in texts.items():
        body = text.split(r"\begin{document}")[-1] if path.name == "paper.tex" else text
        above = text.count("\n") - body.count("\n")
        for line, what in hand_typed(body):
            yield f"{path.name}:{line + above}: the number {what} is typed by hand"
    whole = "\n".join(re.sub(r"(?<!\\)%.*", "", text.split(r"\begin{document}")[-1]) for text in texts.values())
    plain = " ".join(NAMES.sub(blank, whole).split())
    yield from (f"STRUCTURE has '{phrase}', which the text has no more" for phrase in STRUCTURE if phrase not in plain)
    used = set(re.findall(r"\\R\{([^}#]+)\}", whole))
    tables = set(re.findall(r"\\input\{generated/([^}]+)\}", whole))
    made = dict(files())
    known = set(re.findall(r"\\csname R:([^\\]+)\\endcsname", made["numbers.tex"]))
    yield from (f"no number '{key}', which the text wants" for key in sorted(used - known))
    yield from (f"the number '{key}' is computed, but not used" for key in sorted(known - used))
    yield from (f"no table '{name}', which the text wants" for name in sorted(tables - {n[:-4] for n in made}))
    yield from (f"the table '{name}' is computed, but not used"
                for name in sorted({n[:-4]
                                    for n in made} - tables - {"numbers"}))
    for name, text in made.items():
        path = PAPER / "generated" / name
        if not path.exists() or path.read_text() != text:
            yield f"generated/{name} is stale: run paper/scripts/tables.py"
    commands = (PAPER / "results").read_text().split("\n")
    for path in sorted((PAPER / "data").glob("*.about.json")):
        about, study = json.loads(path.read_text()), path.name.split(".")[0]
        sweep = (STUDIES / f"{study}.sweep.toml").exists()
        if about.get("asked") != fingerprint(study) if sweep else about["command"] not in commands:
            yield f"data/{path.name}: the study has changed since: run paper/results"
    cited = {
        key.strip()
        for keys in re.findall(r"\\cite[pt]?(?:\[[^\]]*\])?\{([^}]+)\}", whole)
        for key in keys.split(",")
    }
    entries = set(re.findall(r"@\w+\{([^,]+),", (PAPER / "references.bib").read_text()))
    yield from (f"references.bib has no '{key}'" for key in sorted(cited - entries))
    yield from (f"references.bib: '{key}' is not cited" for key in sorted(entries - cited))


if __name__ == "__main__":
    found = list(problems())
    print("\n".join(found) or "every number of the article is computed")
    sys.exit(bool(found))
