"""Pages of the documentation in headless Chromium, wide, narrow and dark; then faults that the test must see.

    pages.py SITE                            the pages of the folder SITE (build/docs/html); exit code 1: faults
    pages.py SITE --all                      with the page of every C++ header
    pages.py SITE --shots FOLDER PAGE…       screenshots of some pages, wide, narrow and dark

A page fails on: messages of its console, text wider than a narrow screen, contrast below WCAG 2.1 AA, pictures that
do not load, formulas that are not drawn, links to pages or places that do not exist. One directive makes the pages of
all headers: without --all only the longest of each folder is opened, minutes less. Links are followed on all pages.
"""
import re
import shutil
import sys
import tempfile
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag

from report import browser, check
import report

WIDE, NARROW = 1400, 390
# What a page shows now, as a list of faults. Contrast by WCAG 2.1: (lighter + 0.05) / (darker + 0.05) of the relative
# luminances, at least 4.5, for large text 3. Text over pictures and hidden text do not count.
LOOK = r"""
const [contrast, width] = arguments, faults = [], seen = new Set();
const boxes = [document.scrollingElement, ...(width < 600 ? document.querySelectorAll(".content") : [])];
const widest = Math.max(...boxes.map(box => box.scrollWidth)) - width;
if (widest > 1) {  // tables and code scroll by themselves
  const scrolls = e => e.closest(".table-wrapper, pre, .math, .katex-display");
  const wide = [...document.querySelectorAll("article *")].filter(
      e => e.getBoundingClientRect().right > width + 1 && !scrolls(e));
  faults.push(`is ${widest} pixels wider than a screen of ${width} pixels: ` + wide.slice(0, 2).map(
      e => `<${e.localName} class="${e.className}"> ${e.textContent.slice(0, 40)}`).join("; "));
}
for (const picture of document.images)
  if (picture.checkVisibility() && !(picture.complete && picture.naturalWidth > 0))
    faults.push(`does not show the picture ${picture.getAttribute("src")}`);
for (const formula of document.querySelectorAll("article .math"))
  if (!formula.querySelector(".katex") || formula.querySelector(".katex-error"))
    faults.push(`does not draw the formula ${formula.textContent.slice(0, 60)}`);
const parts = color => (color.match(/[\d.]+/g) || []).map(Number);
const over = (a, b) => { const t = a[3] ?? 1; return [0, 1, 2].map(i => t * a[i] + (1 - t) * b[i]); };
const luminance = c => {
  const [r, g, b] = c.map(x => x / 255).map(x => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const backs = new Map();
const behind = element => {  // the color on which the element's text stands
  if (!element) return [255, 255, 255];
  if (!backs.has(element)) {
    const color = parts(getComputedStyle(element).backgroundColor), seen = color.length > 0 && (color[3] ?? 1) > 0;
    const below = seen && (color[3] ?? 1) === 1 ? color : behind(element.parentElement);
    backs.set(element, seen ? over(color, below) : below);
  }
  return backs.get(element);
};
const dark = matchMedia("(prefers-color-scheme: dark)").matches;
if (contrast) {
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; (node = walker.nextNode());) {
    const element = node.parentElement;
    if (!node.data.trim() || seen.has(element) || ["SCRIPT", "STYLE", "NOSCRIPT"].includes(element.tagName)) continue;
    seen.add(element);
    const style = getComputedStyle(element);
    if (!element.checkVisibility({checkOpacity: true, checkVisibilityCSS: true})
        || element.closest(".katex-mathml, .visually-hidden, .skip-to-content, svg")) continue;
    const back = behind(element), front = over(parts(style.color), back);
    const [high, low] = [luminance(front), luminance(back)].sort((a, b) => b - a);
    const size = parseFloat(style.fontSize), large = size >= 24 || (size >= 18.66 && parseInt(style.fontWeight) >= 700);
    const ratio = (high + 0.05) / (low + 0.05);
    if (ratio < (large ? 3 : 4.5))
      faults.push(`has the contrast ${ratio.toFixed(2)} (${dark ? "dark" : "light"}): ${style.color} on `
                  + `${back.map(Math.round)}: <${element.localName} class="${element.className}"> `
                  + node.data.trim().slice(0, 40));
  }
}
return [faults, seen.size];
"""


class Links(HTMLParser):
    """Targets and places of one page."""

    def __init__(self, file):
        super().__init__()
        self.targets, self.places = [], set()
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        if found.get("id"):
            self.places.add(found["id"])
        if tag == "a" and found.get("name"):
            self.places.add(found["name"])
        for key in ("href", "src"):
            if found.get(key) and not (tag == "link" and found.get("rel") == "canonical"):
                self.targets.append(found[key])


def broken_links(site):
    """(page, words) of each link within the site that leads nowhere."""
    pages = {file: Links(file) for file in sorted(site.rglob("*.html"))}
    for file, page in pages.items():
        for target in page.targets:
            path, place = urldefrag(target)
            if re.match(r"[a-z]+:|//", path):
                continue
            other = (file.parent / unquote(path.partition("?")[0])).resolve() if path else file
            if not other.exists():
                yield file, f"has a link to {target}, which does not exist"
            elif place and other in pages and unquote(place) not in pages[other].places and place != "":
                yield file, f"has a link to {target}: no such place"


def screen(page, width, scheme):
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                         {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600})
    page.execute_cdp_cmd("Emulation.setEmulatedMedia",
                         {"features": [{"name": "prefers-color-scheme", "value": scheme}]})


def look_at(page, file):
    """Faults of one page, and the number of its texts."""
    page.get_log("browser")
    page.get(file.resolve().as_uri())
    faults, texts = [], 0
    for width, scheme, contrast in ((WIDE, "light", True), (NARROW, "light", False), (WIDE, "dark", True)):
        screen(page, width, scheme)
        page.execute_script("for (const d of document.querySelectorAll('details')) d.open = true;"
                            "if (!document.getElementById('still')) document.head.insertAdjacentHTML('beforeend',"
                            "    '<style id=still>*, ::before, ::after {transition: none !important}</style>');"
                            "for (const e of document.images) e.loading = 'eager'")
        found, count = page.execute_script(LOOK, contrast, width)
        texts = max(texts, count)
        faults += found
    faults += [f"console: {entry['message']}" for entry in page.get_log("browser") if entry["level"] == "SEVERE"]
    return list(dict.fromkeys(faults)), texts


def use(page, site):
    """The theme switch and the search work."""
    screen(page, WIDE, "light")
    page.get((site / "index.html").resolve().as_uri())
    themes = set()
    for _ in range(3):
        page.execute_script("document.querySelector('.theme-toggle-header .theme-toggle, .theme-toggle').click()")
        themes.add(page.execute_script("return getComputedStyle(document.body).backgroundColor"))
    check(len(themes) == 2, f"the theme switch shows {len(themes)} backgrounds: must be 2")
    page.execute_script("localStorage.clear()")
    for word, wanted in (("warm start", "glossary.html"), ("RowSparse", "reference/cpp/core_lcp/matrix.html")):
        page.get((site / "search.html").resolve().as_uri() + f"?q={word}")
        for _ in range(100):
            found = page.execute_script("return [...document.querySelectorAll('#search-results a')].map(a => a.href)")
            if any(wanted in target for target in found):
                break
            page.execute_async_script("setTimeout(arguments[0], 50)")
        check(any(wanted in target for target in found), f"the search for '{word}' finds {wanted}: {found[:5]}")


# (what, text of the fault, addition to a page): each must be seen.
FAULTS = [
    ("an error of a script", "console:", "<script>nowhere.call()</script>"),
    ("a wide part", "pixels wider", '<div style="width: 900px">wide</div>'),
    ("pale text", "contrast 1.", '<p style="color: #eee; background: #fff">x</p>'),
    ("dark text on dark", "(dark)", '<p style="color: #222">dark</p>'),
    ("a missing picture", "does not show the picture", '<img src="none.png" width="9" height="9">'),
    ("a wrong formula", "does not draw", '<span class="math">\\(\\nothing{\\)</span>'),
]
LINKS = [("a link to no page", "which does not exist", '<a href="none.html">x</a>'),
         ("a link to no place", "no such place", '<a href="#none">x</a>')]


def falsified(page, site):
    """A page with each fault in turn; the page as it is has none."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "html"
        copy.mkdir()
        for name in ("_static", "_images"):
            (copy / name).symlink_to((site / name).resolve())
        text = (site / "glossary.html").read_text(encoding="utf-8")
        for what, words, part in FAULTS:
            (copy / "page.html").write_text(text.replace("</article>", part + "</article>", 1), encoding="utf-8")
            faults, _ = look_at(page, copy / "page.html")
            check(any(words in fault for fault in faults), f"{what} is not seen: {faults}")
        for what, words, link in LINKS:
            (copy / "page.html").write_text(text.replace("</article>", link + "</article>", 1), encoding="utf-8")
            check(any(words in fault for _, fault in broken_links(copy)), f"{what} is not seen")


def shots(page, site, folder, names):
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        for kind, width, scheme in (("wide", WIDE, "light"), ("narrow", NARROW, "light"), ("dark", WIDE, "dark")):
            screen(page, width, scheme)
            page.get((site / name).resolve().as_uri())
            page.execute_async_script("setTimeout(arguments[0], 300)")
            page.save_screenshot(str(folder / f"{name.replace('/', '_').removesuffix('.html')}.{kind}.png"))


def opened(site, everything):
    """The pages that are looked at; those of headers alone make four fifths of all."""
    files = [file for file in sorted(site.rglob("*.html"))
             if not {"_static", "_sources"} & set(file.relative_to(site).parts)]
    headers = {}
    for file in files:
        if file.parent.parent == site / "reference/cpp" and file.name != "index.html":
            headers.setdefault(file.parent, []).append(file)
    left = set() if everything else {file for folder in headers.values()
                                     for file in sorted(folder, key=lambda file: file.stat().st_size)[:-1]}
    return [file for file in files if file not in left]


def main():
    site = Path(sys.argv[1])
    if not (site / "index.html").exists():
        sys.exit(f"pages: no site in {site}: build it first")
    profile = tempfile.mkdtemp(prefix="pages")
    page = browser(profile)
    page.set_script_timeout(30)
    try:
        if "--shots" in sys.argv:
            shots(page, site, Path(sys.argv[3]), sys.argv[4:])
            return
        files = opened(site, "--all" in sys.argv)
        texts = 0
        for file in files:
            faults, count = look_at(page, file)
            texts += count
            check(not faults, "\n  ".join([f"{file.relative_to(site)}:", *faults[:8]]))
        links = list(broken_links(site))
        check(not links, "\n  ".join(["links:", *(f"{file.relative_to(site)} {words}" for file, words in links[:20])]))
        check(len(files) > 90 and texts > 20000, f"only {len(files)} pages with {texts} texts")
        use(page, site)
        falsified(page, site)
    finally:
        page.quit()
        shutil.rmtree(profile, ignore_errors=True)
    print("\n".join(report.wrong) or f"{len(files)} pages, {texts} texts, {report.checks} checks")
    sys.exit(1 if report.wrong else 0)


if __name__ == "__main__":
    main()
