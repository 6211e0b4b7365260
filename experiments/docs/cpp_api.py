"""C++ reference of the site: declarations of the public headers as Doxygen reads them, as Sphinx nodes.

build.py calls collect(), which runs Doxygen and returns the entries of each header: types, functions, constants, each
with signature, comment and members. The directives below, an extension of Sphinx, show them:

    {cpp-header} core/lcp/problem.h     the entries of one header, with links from each type to its declaration
    {cpp-names}                         an index of all names

Why not Breathe: it takes minutes for these headers, since every page repeats the namespace; this takes seconds.
"""
import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from docutils import nodes
from sphinx import addnodes
from sphinx.util.docutils import SphinxDirective

NAMESPACE = "orthant::"
SETTINGS = """
PROJECT_NAME = Orthant
INPUT = {input}
FILE_PATTERNS = *.h
RECURSIVE = YES
OUTPUT_DIRECTORY = "{output}"
STRIP_FROM_PATH = "{root}"
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
FULL_PATH_NAMES = YES
EXTRACT_ALL = YES
MARKDOWN_SUPPORT = NO
AUTOLINK_SUPPORT = NO
QUIET = YES
WARN_IF_UNDOCUMENTED = NO
WARN_IF_DOC_ERROR = NO
INPUT_FILTER = "sed -E 's@^([^/]*[;,]) +// @\\1  ///< @'"
"""  # the filter: a comment at the end of a declaration belongs to it


def pieces(element):
    """A type with its links: [[text, id or None], …]."""
    if element is None:
        return []
    found = [[element.text or "", None]]
    for part in element:
        found += [["".join(part.itertext()), part.get("refid")], [part.tail or "", None]]
    return [[re.sub(r"(?<=<) (?!=)| (?=>(?!=))", "", text), target] for text, target in found if text]


def signature(member):
    """Of a function, variable, type name or enumeration."""
    kind, name = member.get("kind"), member.findtext("name")
    found = []
    if (template := member.find("templateparamlist")) is not None:
        parameters = [" ".join(filter(None, ("".join(p.find("type").itertext()), p.findtext("declname"))))
                      for p in template.findall("param")]
        found.append([f"template <{', '.join(parameters)}> ", None])
    if kind == "enum":
        return [*found, ["enum " + ("class " if member.get("strong") == "yes" else ""), None], [name, "name"]]
    if member.get("static") == "yes":
        found.append(["static ", None])
    if member.get("virt") in ("virtual", "pure-virtual"):
        found.append(["virtual ", None])
    if kind == "typedef":
        return [*found, ["using ", None], [name, "name"], [" = ", None], *pieces(member.find("type"))]
    found += pieces(member.find("type"))
    if found and not found[-1][0].endswith((" ", "&", "*")):
        found.append([" ", None])
    found.append([name, "name"])
    arguments = member.findtext("argsstring") or ""
    if kind == "variable":
        found.append([arguments, None])
        initial = (member.findtext("initializer") or "").strip()
        if initial and "\n" not in initial and len(initial) < 60:
            found.append([" " + initial, None])
        return [piece for piece in found if piece[0]]
    found.append(["(", None])
    for i, parameter in enumerate(member.findall("param")):
        found += [[", ", None]] if i else []
        found += pieces(parameter.find("type"))
        declared = parameter.findtext("declname")
        if declared:
            found.append([("" if found[-1][0].endswith((" ", "&", "*")) else " ") + declared, None])
        if (default := parameter.find("defval")) is not None:
            found.append([" = " + "".join(default.itertext()), None])
    found.append([")" + arguments[arguments.rfind(")") + 1:], None])
    return found


def paragraphs(element):
    """A comment as paragraphs of [kind, text]: text, code, block, item."""
    found = []
    for name in ("briefdescription", "detaileddescription"):
        for para in element.findall(f"{name}/para"):
            part = [["text", para.text or ""]]
            for child in para:
                text = "".join(child.itertext())
                if child.tag in ("verbatim", "programlisting"):
                    part.append(["block", text])
                elif child.tag in ("itemizedlist", "orderedlist"):
                    part += [["item", "".join(item.itertext()).strip()] for item in child]
                else:
                    part.append(["code" if child.tag == "computeroutput" else "text", text])
                part.append(["text", child.tail or ""])
            found.append([p for p in part if p[1].strip()])
    return [p for p in found if p]


def entry(element, parent=""):
    name = element.findtext("name") or element.findtext("compoundname")
    full = element.findtext("qualifiedname") or (parent + "::" if parent else "") + name
    return {"id": element.get("id"), "kind": element.get("kind"), "name": full.removeprefix(NAMESPACE),
            "line": int(element.find("location").get("line")), "file": element.find("location").get("file"),
            "about": paragraphs(element), "members": []}


def members_of(compound):
    for member in compound.findall("sectiondef/memberdef"):
        if member.get("kind") == "friend" or member.get("prot") == "private":
            continue
        found = entry(member)
        found["signature"] = signature(member)
        found["members"] = [{"id": value.get("id"), "kind": "value", "name": value.findtext("name"), "members": [],
                             "about": paragraphs(value), "signature": [[value.findtext("name"), "name"]]}
                            for value in member.findall("enumvalue")]
        yield found


def collect(root, output, folders=("core", "solvers", "integrators")):
    """Entries of each header, in the order of its lines."""
    output.mkdir(parents=True, exist_ok=True)
    settings = SETTINGS.format(input=" ".join(f'"{root / folder}"' for folder in folders), output=output, root=root)
    try:
        run = subprocess.run(["doxygen", "-"], input=settings, text=True, capture_output=True, check=False)
    except FileNotFoundError:
        sys.exit("docs: doxygen is missing, which reads the C++ headers (Debian: doxygen)")
    if run.returncode != 0:
        sys.exit(f"docs: doxygen failed: {run.stderr}")
    types, top = {}, []
    for file in sorted((output / "xml").glob("*.xml")):
        for compound in ElementTree.parse(file).getroot().findall("compounddef"):
            kind = compound.get("kind")
            if kind in ("struct", "class", "union") and compound.get("prot", "public") != "private":
                found = entry(compound)
                found["name"] = compound.findtext("compoundname").removeprefix(NAMESPACE)
                bases = [f"{base.get('prot')} {base.text.removeprefix(NAMESPACE)}"
                         for base in compound.findall("basecompoundref")]
                found["signature"] = [[kind + " ", None], [found["name"], "name"],
                                      [" : " + ", ".join(bases) if bases else "", None]]
                found["members"] = sorted(members_of(compound), key=lambda member: member["line"])
                types[compound.get("id")] = found
            elif kind in ("namespace", "file"):
                top += members_of(compound)
    headers, seen = {}, set()
    for found in [*types.values(), *top]:
        if "detail::" in found["name"] or found["name"].startswith("@") or not found["file"].endswith(".h") or \
                found["id"] in seen:
            continue
        seen.add(found["id"])
        headers.setdefault(found["file"], []).append(found)
    return {file: sorted(found, key=lambda e: e["line"]) for file, found in headers.items()}


def page_of(header):
    path = Path(header)
    return f"reference/cpp/{str(path.parent).replace('/', '_')}/{path.stem}"


def everything(entries):
    for found in entries:
        yield found
        yield from everything(found["members"])


def where(data):
    """The page of each identifier."""
    return {found["id"]: page_of(header) for header, entries in data.items() for found in everything(entries)}


class FromData(SphinxDirective):
    def data(self):
        if not hasattr(self.env, "cpp_api"):
            self.env.cpp_api = json.loads(Path(self.env.srcdir, "reference/cpp/api.json").read_text(encoding="utf-8"))
            self.env.cpp_pages = where(self.env.cpp_api)
        return self.env.cpp_api

    def link(self, text, target):
        page = self.env.cpp_pages.get(target)
        if page is None:
            return nodes.Text(text)
        uri = self.env.app.builder.get_relative_uri(self.env.docname, page) if page != self.env.docname else ""
        reference = nodes.reference("", "", internal=True, refuri=f"{uri}#{target}")
        reference += nodes.Text(text)
        return reference


class Header(FromData):
    required_arguments = 1

    def described(self, found):
        node = addnodes.desc(domain="cpp", objtype=found["kind"], noindex=True, classes=["cpp", found["kind"]])
        heading = addnodes.desc_signature("", "", ids=[found["id"]], classes=["sig"], is_multiline=False)
        for text, target in found["signature"]:
            if target == "name":
                heading += addnodes.desc_name(text, text)
            else:
                heading += self.link(text, target) if target else nodes.Text(text)
        self.state.document.note_explicit_target(heading)
        content = addnodes.desc_content()
        for paragraph in found["about"]:
            line = nodes.paragraph()
            for kind, text in paragraph:
                if kind == "block":
                    content += [line] if line.children else []
                    content += nodes.literal_block(text, text, language="none")
                    line = nodes.paragraph()
                elif kind == "item":
                    content += [line] if line.children else []
                    content += nodes.bullet_list("", nodes.list_item("", nodes.paragraph(text, text)))
                    line = nodes.paragraph()
                else:
                    line += nodes.literal(text, text) if kind == "code" else nodes.Text(text)
            content += [line] if line.children else []
        content += [self.described(member) for member in found["members"]]
        node += [heading, content]
        return node

    def run(self):
        made = []
        for found in self.data().get(self.arguments[0], []):
            if found["kind"] in ("struct", "class", "enum", "function", "typedef"):
                made.append(addnodes.index(entries=[("single", f"{found['name']} (C++)", found["id"], "", None)]))
            made.append(self.described(found))
        return made or [nodes.paragraph("", "This header declares nothing but what it includes.")]


class Names(FromData):
    def run(self):
        names = {}
        for entries in self.data().values():
            for found in entries:
                names.setdefault(found["name"], found["id"])
        made = nodes.bullet_list(classes=["names"])
        for name, target in sorted(names.items(), key=lambda pair: pair[0].lower()):
            line = nodes.paragraph()
            line += self.link(name, target)
            made += nodes.list_item("", line)
        return [made]


def setup(app):
    app.add_directive("cpp-header", Header)
    app.add_directive("cpp-names", Names)
    return {"parallel_read_safe": True}
