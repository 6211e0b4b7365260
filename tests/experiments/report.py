"""Opens a report in headless Chromium as its reader would; prints what went wrong, if anything, and how many checks
held.

report.py REPORT.html [SCREENSHOT.png WIDTH HEIGHT light|dark]
"""
import base64
import sys
import tempfile
import time
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
         "--disable-background-networking", "--disable-component-update", "--hide-scrollbars",
         "--enable-unsafe-swiftshader")  # WebGL without a graphics card
checks, wrong = 0, []


def check(holds, words):
    global checks
    checks += 1
    if not holds:
        wrong.append(words)


def browser(profile):
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


def look(page, width, height, scheme):
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                         {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})
    page.execute_cdp_cmd("Emulation.setEmulatedMedia",
                         {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
    time.sleep(0.3)


def ink(page, index):
    """The pixels of a canvas (film, strip, film, strip), to see whether they change."""
    return page.execute_script(f"return document.querySelectorAll('.films canvas')[{index}].toDataURL()")


def test_animation(page):
    position = "return animations[0].position"
    button = page.find_element(By.CSS_SELECTOR, ".controls button")
    before, where = [ink(page, i) for i in range(4)], page.execute_script(position)
    text = page.execute_script("arguments[0].click(); return arguments[0].textContent", button)
    check(text == "Pause", "the button says Pause while the animation plays")
    for _ in range(100):  # a busy machine draws seldom
        time.sleep(0.1)
        if page.execute_script(position) > where:
            break
    check(page.execute_script(position) > where, "the animation plays")
    check(all(ink(page, i) != before[i] for i in range(4)), "both films and their strips move")
    # On a busy machine it may have come to its end, where a click begins anew.
    page.execute_script("if (animations[0].playing) arguments[0].click()", button)
    where = page.execute_script(position)
    time.sleep(0.2)
    check(page.execute_script(position) == where, "the animation pauses")
    slider = page.find_element(By.CSS_SELECTOR, ".controls input")
    page.execute_script("arguments[0].value = 0.5; arguments[0].dispatchEvent(new Event('input'))", slider)
    check(abs(page.execute_script(position) - 0.5) < 1e-9, "the slider scrubs")
    times = "const t = %s * animations[0].duration; return animations[0].films.map(f => f.film.frames[f.frameAt(t)][0])"
    left, right = page.execute_script(times % 0.5)
    check(left > 0 and abs(left - right) < 1e-5, "both films show the same time")
    cut = ("const film = animations[0].films[1].film, all = film.frames; film.frames = all.slice(0, %s); "
           "return all.length")
    length = page.execute_script(cut % 300)  # as if it had ended early
    left, right = page.execute_script(times % 0.2)
    check(left > 0 and abs(left - right) < 1e-5, "and so they do where one has ended early")
    left, right = page.execute_script(times % 0.9)
    check(0 < right < left, "which stands still from there on")
    check(length > 300, "there was something to cut")
    arrows = ("return animations[0].films.every(f => "
              "f.film.frames.some(x => f.scene.contacts.some((_, i) => f.impulse(x, i) > 0)))")
    check(page.execute_script(arrows), "there are impulses to draw")


def test_plot(page, index):
    over = page.find_elements(By.CSS_SELECTOR, ".u-over")[index]
    page.execute_script("arguments[0].scrollIntoView({block: 'center'})", over)
    at = page.execute_script(f"const p = plots[{index}], l = p.points.findIndex(x => x.length), q = p.points[l][0];"
                             "return [p.plot.valToPos(q.x, 'x'), p.plot.valToPos(q.y, 'y')]")
    width, height = over.size["width"], over.size["height"]
    ActionChains(page).move_to_element_with_offset(over, int(at[0] - width / 2), int(at[1] - height / 2)).perform()
    time.sleep(0.1)
    tip = over.find_element(By.CSS_SELECTOR, ".tip")
    check(tip.is_displayed() and ":" in tip.text, f"plot {index} tells the value under the pointer")
    limits = f"const s = plots[{index}].plot.scales; return [s.x.min, s.x.max, s.y.min, s.y.max]"
    whole = page.execute_script(limits)
    ActionChains(page).move_to_element_with_offset(over, -width // 4, -height // 4).click_and_hold() \
        .move_by_offset(width // 3, height // 3).release().perform()
    time.sleep(0.2)
    zoomed = page.execute_script(limits)
    check(zoomed[1] - zoomed[0] < whole[1] - whole[0] and zoomed[3] - zoomed[2] < whole[3] - whole[2],
          f"dragging zooms plot {index}")
    ActionChains(page).double_click(over).perform()
    time.sleep(0.2)
    check(page.execute_script(limits) == whole, f"a double click shows all of plot {index} again")
    if (
        page.execute_script(f"return plots[{index}].plot.scales.x.distr") == 3
    ):  # logarithmic: labels in any range, at once
        for low, high in ((2e-5, 3e-5), (2e-5, 9e-5), (23.2, 309), (1e-9, 1e3)):
            begin = time.monotonic()
            labels = page.execute_script(f"const p = plots[{index}].plot; p.setScale('x', {{min: {low}, max: {high}}});"
                                         "return new Promise(done => requestAnimationFrame(() => "
                                         "done(p.axes[0]._values.filter(label => label))))")
            check(labels and time.monotonic() - begin < 2, f"plot {index} has labels from {low} to {high}: {labels}")
        ActionChains(page).double_click(over).perform()
    name = page.find_element(By.CSS_SELECTOR, ".legend button")
    name.click()
    check(name.get_attribute("aria-pressed") == "false", "a name in the legend hides its line")
    name.click()


def test_page(page):
    check(page.execute_script("return document.title").startswith("Orthant: "), "the page has a title")
    check(len(page.find_elements(By.CSS_SELECTOR, ".answer")) > 0, "the page has an answer")
    plots = page.execute_script("return plots.length")
    check(
        page.execute_script("return plots.filter(p => p.figure.x_label === 'mu').every(p => p.figure.lines.every(l => "
                            "l.x.every((x, i) => i === 0 || l.x[i - 1] <= x)))"), "a line goes from left to right")
    check(plots > 0, "the page has plots")
    check("`" not in page.find_element(By.TAG_NAME, "body").text, "no mark of a source text is left")
    check(
        page.execute_script(
            "return [...document.querySelectorAll('table')].every(t => [...t.rows[0].cells].every((_, c) => "
            "[...t.rows].slice(1).some(row => row.cells[c].textContent)))"), "no column of a table is empty")
    for width, scheme in ((1100, "light"), (390, "dark"), (1100, "dark")):
        look(page, width, 900, scheme)
        check(page.execute_script("return document.documentElement.scrollWidth") <= width,
              f"nothing is wider than a screen of {width} pixels")
    if page.execute_script("return animations.length"):
        test_animation(page)
    for index in range(plots):
        test_plot(page, index)


def main():
    file, *shot = sys.argv[1:]
    with tempfile.TemporaryDirectory() as profile:
        page = browser(profile)
        try:
            page.get(Path(file).resolve().as_uri())
            if shot:
                width, height = int(shot[1]), int(shot[2])
                look(page, width, height, shot[3])
                picture = page.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True})
                Path(shot[0]).write_bytes(base64.b64decode(picture["data"]))
            else:
                test_page(page)
            for entry in page.get_log("browser"):
                check(entry["level"] != "SEVERE", f"console: {entry['message']}")
        finally:
            page.quit()
    print("\n".join(wrong + [f"{checks - len(wrong)} of {checks} checks hold"]))
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
