// Draws what Sphinx has marked as formulas, \( … \) and \[ … \], by KaTeX.
document.addEventListener("DOMContentLoaded", () => {
  for (const element of document.querySelectorAll(".math")) {
    const display = element.tagName === "DIV";
    const source = element.textContent.trim().replace(/^\\[[(]/, "").replace(/\\[\])]$/, "");
    katex.render(source, element, {displayMode: display, throwOnError: false});
  }
});
