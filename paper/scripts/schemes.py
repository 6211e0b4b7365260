"""What the article says of the schemes before any is run: orders, each as the scheme's own header states it."""
import re

from data import PAPER, tex

# On smooth motion, with impacts; None: to a tolerance. And the words of NAME.h below integrators/ that say so.
ORDERS = {
    "moreau-jean": (2, 1, "Order 1 with impacts; 2 on smooth motion for θ = ½ and symmetric joints"),
    "stewart-trinkle": (1, 1, "Order 1, on smooth motion too"),
    "anitescu-potra": (1, 1, "Order 1 for e = 0, as Stewart–Trinkle"),
    "paoli-schatzman": (1, 1, "Order 1: v is a backward difference"),
    "generalized-alpha": (2, 1, "Order 2 on smooth motion for every ρ_∞; 1 with impacts"),
    "rattle": (2, 1, "Order 2 on smooth motion and in contacts that last. With impacts 1"),
    "adaptive": (None, None, "event location and dense output to a tolerance"),
    "event-driven": (None, None, "the smooth motion by a Runge–Kutta method of order 8"),
}
CLASSICAL = 1  # of moreau-jean with joints on velocity level, on smooth motion: the article's own proposition
NUMERALS = "no one two three four five six seven eight nine ten eleven twelve".split()


def numeral(n):
    """A count as a word, where there is one."""
    return NUMERALS[n] if n < len(NUMERALS) else str(n)


def numbers(n):
    for name, (smooth, impacts, said) in ORDERS.items():
        header = next((PAPER.parent / "integrators").resolve().rglob(f"{name.replace('-', '_')}.h"))
        if said not in re.sub(r"\n//\s*", " ", header.read_text()):
            raise SystemExit(f"{header.name} no longer says '{said}': what order has {name}?")
        if smooth is not None:
            star = rf" ($\ensuremath{{{CLASSICAL}}}^*$)" if name == "moreau-jean" else ""
            n[f"orders/{name}"] = f"{tex(smooth, 1)}{star}, {tex(impacts, 1)}"
    n["orders/star"] = rf"${CLASSICAL}^*$"
    n["orders/schemes"] = numeral(len(ORDERS))
    n["orders/pair"] = numeral(int(re.search(r"order (\d+)", ORDERS["event-driven"][2]).group(1)))


def tables(t):
    pass
