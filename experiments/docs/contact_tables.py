"""Tables of contacts and joints of Orthant and other programs: of data/contacts.csv, which
`experiments/benchmarks/contacts/contacts.py` writes, into compare_contacts.md. --check: says whether the page has them,
and writes nothing. Pictures are drawn when the site is built (build.py).
"""
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "benchmarks/contacts"))
import summary  # noqa: E402

PAGE, DATA = HERE / "compare_contacts.md", HERE / "data/contacts.csv"


def parts(rows):
    """What stands between the marks of the page, by their names."""
    scenes = {name: summary.table(own) for name, own in summary.by_scene(rows).items()}
    return scenes | {"behind": summary.behind_table(rows), "failures": summary.failures(rows)}


def filled(page, rows):
    for name, text in parts(rows).items():
        begin, end = f"<!-- {name}: contact_tables.py -->\n", f"<!-- end of {name} -->\n"
        if page.count(begin) != 1 or page.count(end) != 1:
            sys.exit(f"{PAGE.name}: must have the marks of '{name}' once")
        head, rest = page.split(begin)
        page = head + begin + text + end + rest.split(end)[1]
    return page


def pictures(to):
    for name, own in summary.by_scene(summary.read(DATA)).items():
        summary.draw(own, to / f"contacts_{name}.svg")


def main():
    page = PAGE.read_text(encoding="utf-8")
    new = filled(page, summary.read(DATA))
    if "--check" in sys.argv[1:]:
        if new != page:
            sys.exit(f"{PAGE.name}: its tables are not those of {DATA.name}: run contact_tables.py")
        return
    PAGE.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    main()
