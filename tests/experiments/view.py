"""Opens views of runs in headless Chromium as their readers would; prints what went wrong, and how many checks held.

view.py ORTHANT [FOLDER]: pages are made by the command, in FOLDER (kept) or in a temporary one.
"""
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import report as browsing
from report import browser, check, look
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By


def pages(command, folder):
    """Name of each page, and whether its run has located events and a drawing."""
    def run(*words):
        return subprocess.run([command, *words], cwd=folder, capture_output=True, text=True, check=True)
    run("view", "slider_crank", "--set", "mu=0.1")
    run("simulate", "rocking_block", "--integrator", "adaptive", "--output", "rocking.csv")
    run("view", "rocking.csv", "--scene", "rocking_block", "--output", "rocking.html")
    bare = run("view", "rocking.csv", "--output", "bare.html")
    check("bodies are shown as points" in bare.stderr, "a CSV file without a scene is noted")
    run("simulate", "bouncing_ball", "--integrator", "moreau-jean", "--output", "ball.h5")
    run("view", "ball.h5")
    run("view", "slider_crank_space", "--duration", "0.06")
    run("simulate", "masse", "--output", "masse.csv")
    run("view", "masse.csv", "--output", "bare_masse.html")
    run("view", "masse.csv", "--scene", "masse")
    run("simulate", "flyball", "--output", "flyball.h5", "--duration", "1")
    run("view", "flyball.h5")
    return {"slider_crank": (True, True), "rocking": (True, True), "bare": (True, False), "ball": (False, True),
            "slider_crank_space": (False, True), "masse": (False, True), "bare_masse": (False, False)}


def stage(page):
    return page.execute_script("return document.querySelector('.films canvas').toDataURL()")


def test_view(page, events, drawn):
    check(page.execute_script("return document.title").startswith("Orthant: "), "the page has a title")
    check(
        page.execute_script("return (scene.outlines ?? scene.solids).length > 0") == drawn,
        "there is a drawing where the run has one")
    check(page.execute_script("return plots.length") == 2, "two plots to begin with")
    for width, scheme in ((1100, "light"), (390, "dark")):
        look(page, width, 900, scheme)
        check(
            page.execute_script("return document.documentElement.scrollWidth") <= width,
            f"nothing is wider than {width} pixels")
    before = stage(page)
    body = page.find_element(By.TAG_NAME, "body")
    page.execute_script("player.seconds *= 8")  # on a busy machine it must not come to its end meanwhile
    body.send_keys(" ")
    browsing.time.sleep(0.7)
    body.send_keys(" ")
    time = page.execute_script("return player.time")
    check(time > 0 and stage(page) != before, "the space bar plays, and the picture moves")
    browsing.time.sleep(0.2)
    check(page.execute_script("return player.time") == time, "and pauses")
    page.execute_script("player.seconds /= 8")
    missed = page.execute_script(
        "const now = player.position, missed = t.filter((when, k) => { player.position = when / last;"
        "return frameAt(player.time) !== k; }); player.position = now; return missed.length")
    check(missed == 0, f"a frame's own time shows it; {missed} do not")
    frame = page.execute_script("return frameAt(player.time)")
    body.send_keys(browsing_keys().ARROW_RIGHT)
    check(page.execute_script("return frameAt(player.time)") == frame + 1, "an arrow key steps by one frame")
    page.execute_script("player.speed.value = '0.01'")
    check(page.execute_script("return Number(player.speed.value)") == 0.01, "slow motion is offered")
    over = page.find_element(By.CSS_SELECTOR, ".u-over")
    page.execute_script("arguments[0].scrollIntoView({block: 'center'})", over)
    ActionChains(page).move_to_element(over).click().perform()
    browsing.time.sleep(0.2)
    middle = page.execute_script("return plots[0].plot.posToVal(plots[0].plot.over.clientWidth / 2, 'x')")
    check(abs(page.execute_script("return player.time") - middle) < 0.01 * page.execute_script("return last"),
          "a click into a plot moves the animation there")
    page.execute_script("const s = plots[0].bar.querySelector('select'); s.value = choices[0]; s.onchange()")
    check(page.execute_script("return plots[0].plot.series.length") == 3, "a column is added to a plot")
    force = page.execute_script(
        "const f = forces.filter(n => n.endsWith('_n')); return f.some(n => values[n].some(x => x > 0))")
    check(force, "there are contact forces")
    sums = page.execute_script(
        "return forces.every(n => { const i = values[n.replace('force', 'impulse')];"
        "return values[n].every((x, k) => k === 0 ||"
        "  Math.abs(x * (t[k] - t[k - 1]) - i[k]) <= 1e-9 * Math.abs(i[k])) })")
    check(sums, "a force times the length of its frame is the impulse")
    shown = page.execute_script(
        "const before = player.films[0].canvas.toDataURL(), now = player.time;"
        "const k = player.films[0].film.frames.findIndex("
        "  f => scene.contacts.some((_, i) => player.films[0].impulse(f, i) > 0));"
        "player.go(t[k]); const on = player.films[0].canvas.toDataURL(); show.forces.click();"
        "const off = player.films[0].canvas.toDataURL(); show.forces.click(); return on !== off")
    check(shown == drawn, "forces are drawn where the drawing knows their place, and can be switched off")
    rows = page.find_elements(By.CSS_SELECTOR, ".events tr")
    check((len(rows) > 1) == events, "located events are listed")
    if events:
        page.execute_script("arguments[0].click()", rows[2])
        check(page.execute_script("return Math.abs(player.time - events[1][0]) < 1e-9"),
              "a click on an event goes there")
        check("now" in rows[2].get_attribute("class") or page.execute_script("return events[1][0] === events[2][0]"),
              "and marks it")


ARROW = """
const film = player.films[0], { group, cone } = film.arrows[arguments[0]];
const up = (q) => [2 * (q.x * q.y - q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z + q.w * q.x)];
const at = group.position.toArray().map((x, i) => x * film.size + film.middle.toArray()[i]);
return { shown: group.visible, cone: cone.visible, at, along: up(group.quaternion), normal: up(cone.quaternion) };
"""


def distance(page):
    return page.execute_script("return player.films[0].camera.position.length()")


def test_orbit(page):
    canvas = page.find_element(By.CSS_SELECTOR, ".films canvas")
    page.execute_script("arguments[0].scrollIntoView({block: 'center'})", canvas)
    before, where = stage(page), page.execute_script("return player.films[0].camera.position.toArray()")
    far = distance(page)
    ActionChains(page).move_to_element(canvas).click_and_hold().move_by_offset(120, 40).release().perform()
    browsing.time.sleep(0.2)
    now = page.execute_script("return player.films[0].camera.position.toArray()")
    check(now != where and abs(distance(page) - far) < 1e-6 * far, "dragging turns about the middle")
    check(stage(page) != before, "and draws at once")
    page.execute_script(
        "arguments[0].dispatchEvent(new WheelEvent('wheel', {deltaY: -400, bubbles: true, cancelable: true}))", canvas)
    browsing.time.sleep(0.2)
    check(distance(page) < 0.99 * far, "the wheel zooms")
    for axis, words in enumerate(("along x", "along y", "along z")):
        page.execute_script(
            "[...document.querySelectorAll('button')].find(b => b.textContent === arguments[0]).click()", words)
        sight = page.execute_script("return player.films[0].camera.position.toArray().map(Math.abs)")
        check(sight[axis] > 0.999 * sum(sight), f"a button looks {words}")
    page.execute_script("[...document.querySelectorAll('button')].find(b => b.textContent === 'whole').click()")
    check(abs(distance(page) - far) < 1e-6 * far, "and one shows the whole")


def test_space(page, name):
    test_orbit(page)
    film = "player.films[0]"
    check(page.execute_script(f"return {film}.renderer.shadowMap.enabled") is False, "shadows are off by default")
    page.execute_script("player.go(0.3 * last)")
    choices = ["shadows", "paths"] if name == "masse" else ["joints", "paths"]
    for choice in choices:
        before = stage(page)
        page.execute_script(f"show.{choice}.click()")
        check(stage(page) != before, f"{choice} are drawn, or not")
        page.execute_script(f"show.{choice}.click()")
        check(stage(page) == before, f"and back again: {choice}")
    # Bodies stand where the columns have them.
    worst = page.execute_script("""
        const film = player.films[0], k = frameAt(player.time), p = new THREE.Vector3();
        film.stage.updateMatrixWorld();
        return Math.max(...scene.bodies.map(({name}, i) => {
          film.movers[i].getWorldPosition(p).multiplyScalar(film.size).add(film.middle);
          return Math.hypot(p.x - values[`${name}.x`][k], p.y - values[`${name}.y`][k], p.z - values[`${name}.z`][k]);
        }))""")
    check(worst < 1e-6, "bodies are drawn at their positions")
    if name == "masse":  # it slides: the force lies on the cone of friction, against the slip
        page.execute_script("player.go(t[10])")
        force = page.execute_script(ARROW, 0)
        check(force["shown"] and force["cone"], "a pushing contact has its arrow and its cone")
        x, y, z = (page.execute_script(f"return values['ball.{part}'][10]") for part in "xyz")
        radius = page.execute_script("return scene.contacts[0].radius")
        check(
            max(abs(a - b) for a, b in zip(force["at"], (x, y, z - radius))) < 1e-6,
            "the arrow begins where the ball touches")
        cosine = sum(a * b for a, b in zip(force["along"], force["normal"]))
        mu = page.execute_script("return scene.contacts[0].mu")
        check(abs(cosine - 1 / (1 + mu * mu) ** 0.5) < 1e-5, "while it slides, the force lies on the cone")
        slip = page.execute_script("const v = n => values[`ball.${n}`][10], r = scene.contacts[0].radius;"
                                   "return [v('vx') - r * v('wy'), v('vy') + r * v('wx')]")
        tangent = [force["along"][0], force["along"][1]]
        against = sum(a * b for a, b in zip(slip, tangent)) / (sum(a * a for a in slip) * sum(a * a
                                                                                              for a in tangent))**0.5
        check(against < -0.999, "against its slip")
        page.execute_script("show.cones.click()")
        check(not page.execute_script(ARROW, 0)["cone"], "cones can be switched off")
        page.execute_script("show.cones.click()")
    else:
        check(page.execute_script(f"return {film}.joints.length") == 3, "each joint has a mark")


def test_without_webgl(page, file):
    """In a browser that has none, plots and events remain."""
    hide = page.execute_cdp_cmd(
        "Page.addScriptToEvaluateOnNewDocument", {
            "source": "const get = HTMLCanvasElement.prototype.getContext;"
            "HTMLCanvasElement.prototype.getContext = function (kind, ...more) {"
            "  return /webgl/.test(kind) ? null : get.call(this, kind, ...more); }"
        })
    page.get(file.resolve().as_uri())
    check("no WebGL" in page.find_element(By.CSS_SELECTOR, ".films").text, "without WebGL the page says so")
    check(page.execute_script("return plots.length") == 2, "and has its plots")
    page.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", hide)
    page.get_log("browser")
STRANGE = "</script><img src=x onerror=window.broken=1>"


def test_strangers(page, command, folder):
    """Files of others: names that are markup, columns that JavaScript knows, and what is no run at all."""
    body = ("0,1,2,0,0.1,7,7\n", "0.5,1,1,0,0.2,7,7\n", "1,inf,nan,0,0.3,7,7\n")
    (folder / "strange.csv").write_text("t," + ",".join(f"{STRANGE}.{part}" for part in ("x", "y", "theta", "gap"))
                                        + ",__proto__,constructor.x\n" + "".join(body))
    (folder / "strange.events.csv").write_text(f"t,kind,contact,impulse_n,impulse_t\n0.5,{STRANGE},{STRANGE},1,0\n")
    subprocess.run([command, "view", "strange.csv"], cwd=folder, capture_output=True, check=True)
    page.get((folder / "strange.html").resolve().as_uri())
    page.execute_script("plots[0] || plots.push(new TimePlot(columns, [choices[0]]));"
                        "for (const name of choices) plots[0].columns.push(name); plots[0].draw(); player.go(0.5)")
    browsing.time.sleep(0.3)
    check(page.execute_script("return window.broken === undefined && document.images.length === 0"),
          "names are text, not markup")
    check(page.execute_script("return document.body.textContent").count("onerror=") > 4, "and they are shown")
    for entry in page.get_log("browser"):
        check(entry["level"] != "SEVERE", f"strange: console: {entry['message']}")
    for name, text, words in (("empty.csv", "t,a.x\n", "must be a trajectory"), ("word.csv", "t,a.x\n0,1\n1,x\n",
                                                                                 "line 3: must hold numbers"),
                              ("short.csv", "t,a.x\n0\n", "has 1 cells: must have 2"), ("back.csv", "t,a.x\n1,1\n0,2\n",
                                                                                        "row 2: t must be finite"),
                              ("nan.csv", "t,a.x\nnan,1\n", "row 1: t must be finite"),
                              ("twice.csv", "t,a.x,a.x\n0,1,2\n", "column a.x: is there twice"), ("junk.h5", "junk",
                                                                                                  "is no HDF5 file")):
        (folder / name).write_text(text)
        run = subprocess.run([command, "view", name], cwd=folder, capture_output=True, text=True)
        check(run.returncode == 1 and words in run.stderr and not (folder / name).with_suffix(".html").exists(),
              f"{name} is refused: {run.returncode} {run.stderr}")
    (folder / "bytes.csv").write_bytes(b"t,\xff.x\n0,1\n1,2\n")
    run = subprocess.run([command, "view", "bytes.csv"], cwd=folder, capture_output=True, text=True)
    check(run.returncode == 0 and "\\\\xff.x" in (folder / "bytes.html").read_text(),
          f"a name that is no UTF-8 is shown: {run.stderr}")


def test_pile(page, command, folder):
    """Of searched collisions each pair that pushes has its arrow: their impulses add up to the collision's."""
    subprocess.run([command, "view", "pile", "--integrator", "moreau-jean", "--step", "2e-3", "--duration", "0.4"],
                   cwd=folder, capture_output=True, check=True)
    check((folder / "pile.html").stat().st_size < 2_000_000, "pile: less than 2 MB")
    page.get((folder / "pile.html").resolve().as_uri())
    sums = page.execute_script(
        "const of_contact = n => scene.contacts.some(o => n === o.name + '.impulse_n');"
        "const c = data.columns.filter(n => n.endsWith('.impulse_n') && !of_contact(n));"
        "return data.pushes.map((frame, k) =>"
        "  [frame.reduce((s, p) => s + p[4], 0), c.reduce((s, n) => s + values[n][k], 0)])")
    check(any(there > 0 for there, _ in sums), "pairs push")
    check(all(abs(a - b) <= 1e-3 * b for a, b in sums), "the arrows' impulses add up to the collision's")
    unit = page.execute_script(
        "return data.pushes.every(f => f.every(p => Math.abs(Math.hypot(p[2], p[3]) - 1) < 1e-3))")
    check(unit, "along unit normals")
    shown = page.execute_script(
        "const k = data.pushes.findIndex(f => f.length > 0); player.go(t[k]);"
        "const on = player.films[0].canvas.toDataURL(); show.forces.click();"
        "const off = player.films[0].canvas.toDataURL(); show.forces.click(); return on !== off")
    check(shown, "and they are drawn")
    for entry in page.get_log("browser"):
        check(entry["level"] != "SEVERE", f"pile: console: {entry['message']}")


def browsing_keys():
    from selenium.webdriver.common.keys import Keys
    return Keys


def test_server(command, folder):
    server = subprocess.Popen([command, "view", "ball.h5", "--serve", "0"], cwd=folder, stdout=subprocess.PIPE,
                              text=True)
    try:
        address = server.stdout.readline().split()[1]
        check(address.startswith("http://127.0.0.1:"), "the server is on this machine only")
        with urllib.request.urlopen(address, timeout=10) as answer:
            check(answer.read() == (folder / "ball.html").read_bytes(), "it serves the page")
        try:
            urllib.request.urlopen(address + "etc/passwd", timeout=10)
            check(False, "and nothing else")
        except urllib.error.HTTPError as error:
            check(error.code == 404, "and nothing else")
    finally:
        server.terminate()
    check(server.wait(timeout=10) == 0, "a signal ends it")


def main():
    command, *kept = sys.argv[1:]
    with tempfile.TemporaryDirectory() as profile, tempfile.TemporaryDirectory() as temporary:
        folder = Path(kept[0] if kept else temporary)
        made = pages(str(Path(command).resolve()), folder)
        page = browser(profile)
        try:
            for name, (events, drawn) in made.items():
                file = folder / f"{name}.html"
                check(file.stat().st_size < 2_000_000, f"{name}: less than 2 MB")
                before = len(browsing.wrong)
                page.get(file.resolve().as_uri())
                test_view(page, events, drawn)
                text, in_space = file.read_text(encoding="utf-8"), name in ("slider_crank_space", "masse", "bare_masse")
                check(("three.js authors" in text and "The MIT License" in text) == in_space,
                      f"{name}: three.js, with its licence, is in pages of scenes in space only")
                if in_space and drawn:
                    test_space(page, name)
                check(in_space or page.execute_script("return typeof THREE") == "undefined", f"{name}: is planar")
                for entry in page.get_log("browser"):
                    check(entry["level"] != "SEVERE", f"console: {entry['message']}")
                browsing.wrong[before:] = [f"{name}: {words}" for words in browsing.wrong[before:]]
            test_without_webgl(page, folder / "masse.html")
            test_strangers(page, str(Path(command).resolve()), folder)
            test_pile(page, str(Path(command).resolve()), folder)
        finally:
            page.quit()
        test_server(str(Path(command).resolve()), folder)
    print("\n".join(browsing.wrong))
    print(f"{browsing.checks - len(browsing.wrong)} of {browsing.checks} checks hold")
    return 1 if browsing.wrong or browsing.checks < 150 else 0


if __name__ == "__main__":
    sys.exit(main())
