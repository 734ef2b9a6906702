#!/usr/bin/python3
"""docs/site/build.py OUT: writes the pages of docs/ to OUT as plain HTML that is read and searched from disk, without a network.

The order of the pages is that of the links of docs/index.md. Markdown is taken as GitHub takes it (CommonMark and tables), with
GitHub's anchors. Exit code 1, naming page and link, when a link or an anchor leads nowhere or index.md leaves out a page.
Needs Debian's python3-markdown-it. Not mkdocs: its Markdown reads emphasis into "P* and C*", and its search needs a server.
"""
import html
import json
import re
import shutil
import sys
from pathlib import Path
from string import Template

from markdown_it import MarkdownIt

DOCS = Path(__file__).resolve().parent.parent
SITE = DOCS / "site"


def slug(text, taken):
    """GitHub's anchor of a heading; `taken` holds those of the page so far."""
    plain = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
    unique, count = plain, 0
    while unique in taken:
        count += 1
        unique = f"{plain}-{count}"
    taken.add(unique)
    return unique


def text_of(inline):
    return "".join(" " if child.type == "softbreak" else child.content for child in inline.children)


class Page:
    """One page: its HTML, anchors, links and the sections that the search knows."""

    def __init__(self, name):
        self.name = name  # relative to docs/, with .md
        self.url = name.removesuffix(".md") + ".html"
        self.links, self.anchors, self.sections = [], set(), []
        markdown = MarkdownIt("commonmark", {"html": True}).enable("table")
        tokens = markdown.parse((DOCS / name).read_text(encoding="utf-8"))
        self.title = next(text_of(tokens[i + 1]) for i, t in enumerate(tokens) if t.type == "heading_open")
        self.headings = []  # of the second level: anchor, text
        for i, token in enumerate(tokens):
            if token.type == "heading_open":
                heading = text_of(tokens[i + 1])
                token.attrSet("id", slug(heading, self.anchors))
                self.sections.append({"url": f"{self.url}#{token.attrGet('id')}", "page": self.title,
                                      "title": heading, "text": ""})
                if token.tag == "h2":
                    self.headings.append((token.attrGet("id"), heading))
            elif token.type == "inline":
                if tokens[i - 1].type != "heading_open":
                    self.sections[-1]["text"] += text_of(token) + " "
                for child in token.children:
                    self.follow(child)
            elif token.type in ("fence", "code_block"):
                self.sections[-1]["text"] += token.content + " "
        body = markdown.renderer.render(tokens, markdown.options, {})
        self.body = body.replace("<table>", '<div class="scroll"><table>').replace("</table>", "</table></div>")

    def follow(self, token):
        for name in ("href", "src"):
            link = token.attrGet(name)
            if link and not re.match(r"[a-z]+:", link):
                self.links.append(link)
                token.attrSet(name, re.sub(r"\.md(?=#|$)", ".html", link))


def fault_of(page, link, pages):
    """What is wrong with a link of a page, or nothing."""
    path, _, anchor = link.partition("#")
    target = (DOCS / page.name).parent.joinpath(path).resolve() if path else DOCS / page.name
    if not target.is_file() or DOCS not in target.parents:
        return "leads to no file of docs/"
    name = target.relative_to(DOCS).as_posix()
    if target.suffix == ".md" and name not in pages:
        return "leads to a page that docs/index.md leaves out"
    if anchor and anchor not in pages[name].anchors:
        return "has an anchor that is not there"
    return ""


def navigation(page, order, pages):
    up = "../" * page.name.count("/")
    out = []
    for heading, names in order:
        out.append(f"<h2>{html.escape(heading)}</h2>\n<ul>")
        for title, name in names:
            here = ' aria-current="page"' if name == page.name else ""
            out.append(f'<li><a href="{up}{pages[name].url}"{here}>{html.escape(title)}</a>')
            if here and len(page.headings) > 1:
                out.append("<ul>" + "".join(f'<li><a href="#{anchor}">{html.escape(text)}</a></li>'
                                            for anchor, text in page.headings) + "</ul>")
            out.append("</li>")
        out.append("</ul>")
    return "\n".join(out)


def contents():
    """Headings of docs/index.md with the titles and pages that they list."""
    order = []
    for line in (DOCS / "index.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            order.append((line[3:], []))
        item = re.match(r"- \[([^\]]+)\]\(([^)#]+\.md)\)", line)
        if item:
            order[-1][1].append((item[1], item[2]))
    return order


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: docs/site/build.py OUT")
    out = Path(sys.argv[1])
    order = contents()
    pages = {name: Page(name) for name in ["index.md"] + [name for _, names in order for _, name in names]}
    faults = [f"docs/{page.name}: ({link}) {fault}" for page in pages.values() for link in page.links
              if (fault := fault_of(page, link, pages))]
    faults += [f"docs/{name}: docs/index.md leaves it out" for name in
               sorted(p.relative_to(DOCS).as_posix() for p in DOCS.rglob("*.md")) if name not in pages]
    if faults:
        sys.exit("\n".join(faults))

    template = Template((SITE / "page.html").read_text(encoding="utf-8"))
    for page in pages.values():
        target = out / page.url
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(template.substitute(
            title=html.escape(page.title), up="../" * page.name.count("/"), navigation=navigation(page, order, pages),
            body=page.body), encoding="utf-8")
    sections = [section for page in pages.values() for section in page.sections]
    (out / "search-index.js").write_text(f"searchIndex = {json.dumps(sections, ensure_ascii=False)};\n", encoding="utf-8")
    for name in ("search.js", "site.css"):
        shutil.copy(SITE / name, out / name)
    for folder in ("images", "schemas"):
        shutil.copytree(DOCS / folder, out / folder, dirs_exist_ok=True)
    print(f"{len(pages)} pages, {sum(len(page.links) for page in pages.values())} links: {out / 'index.html'}")


main()
