"""Sweeps: every combination of what lists hold, into one SQLite file."""

from __future__ import annotations

import importlib
import importlib.util
import json
import os
import select
import signal
import subprocess
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, NoReturn, Union

from . import _orthant
from ._scene import Scene, registered_scenes, toml_lines
from ._spec import flag, path, registered, shown, whole

if TYPE_CHECKING:
    import pandas

_LOOK_AGAIN = 0.2  # [s]
_WRITTEN = "# Written by orthant.sweep"


def sweep(what: Union[str, os.PathLike[str], Scene], *, results: Union[str, os.PathLike[str], None] = None,
          quick: bool = False, retry: bool = False, jobs: int = 0, client: Any = None, progress: bool = True,
          **keys: Any) -> Union[pandas.DataFrame, list[dict[str, Any]]]:
    """Run every case of a sweep that its results lack; give back all its rows, as a pandas frame where there is pandas.

    what: a sweep file, NAME.sweep.toml, or a scene (a Scene, built-in name or TOML file) with that file's keys by
    keyword: measure (a column of the trajectory), duration [s], reference ("exact", an integrator, a number, or a CSV
    file's path), grid={"integrator": [...], "step": [...], "set": {"mu": [...]}} or a list
    of such. Then the file is written next to the results, and `orthant sweep` takes it, too.
    results: SQLite file, default results/NAME.sqlite. A row a case, by a key of all that determines it: killed and
    called again, what is missing is done; several programs may work at one file. quick: the file's reduced grid.
    retry: run what a time limit or a crash ended once more; what had less time than it gets now is run anyway.
    jobs: processes on this machine, 0: one a core. client: a distributed.Client or its scheduler's address; its workers
    run the cases then, and need this build and the sweep's file at the same place. progress: a tqdm bar, where there is
    tqdm. Names that this process has registered (register_solver, register_integrator, register_scene) are known to no
    fresh one: then a fork of this process runs the cases, each in a fork of its own, with the same jobs and time
    limits; where a crash is a row, too. What functions change or print there is lost. Systems without fork run such
    cases in this process, one by one. Rows do not notice that a function has changed.
    A case that fails is a row with its status. Raises ValueError naming file, key, value and rule, RuntimeError for a
    file that cannot be read.
    """
    jobs, quick = whole("jobs", jobs, 0, 10000, " (0: one a core)"), flag("quick", quick)
    retry = flag("retry", retry)
    progress, results = flag("progress", progress), None if results is None else path("results", results)
    file, results = _files(what, results, keys)
    name, count, missing = _orthant._declare_sweep(file, quick, results, retry)
    ours = sorted(registered & _orthant._names_in_sweep(file, quick))
    if ours and client is not None:
        raise ValueError(
            f"{ours[0][0]} '{ours[0][1]}': is registered in this process only: must not be in a sweep with a client; "
            "without one, forks of this process know it")
    with _Bar(name, count, progress) as bar:
        bar.at(count - len(missing))
        if not missing:
            pass
        elif ours and hasattr(os, "fork"):
            _by_forks(file, quick, results, jobs, name, bar)
        elif ours:
            for done, key in enumerate(missing, count - len(missing) + 1):
                _orthant._run_case_here(file, quick, results, key)
                bar.at(done)
        elif client is None:
            _by_processes(file, quick, results, jobs, name, bar)
        else:
            _by_dask(client, file, quick, results, missing, bar)
    return _table(_orthant._sweep_rows(results, name))


def _files(what: Any, results: Any, keys: dict[str, Any]) -> tuple[Path, Path]:
    if isinstance(what, str) and what in registered_scenes and not (known := registered_scenes[what])._customs:
        what = known if known._read is None or known._read.text and not known._read.sets else what
    text = _text_of(what) if isinstance(what, Scene) else None
    given = Path("scene" if text is not None else path("what", what))
    if given.name.endswith(".sweep.toml"):
        if keys:
            raise TypeError(f"{next(iter(keys))}: a sweep file holds its keys itself: must be given for a scene only")
        name = given.name[: -len(".sweep.toml")]
        return given.absolute(), Path(results or f"results/{name}.sqlite").absolute()
    kept = Path(results or f"results/{given.stem}.sqlite").absolute()
    kept.parent.mkdir(parents=True, exist_ok=True)
    scene = str(given.absolute()) if given.suffix == ".toml" else str(given)
    if text is not None:
        scene = kept.with_suffix(".scene.toml").name
        _write(kept.with_suffix(".scene.toml"), text)
    if str(keys.get("reference", "")).endswith(".csv"):  # the sweep's file may be elsewhere
        keys["reference"] = str(Path(path("reference", keys["reference"])).absolute())
    file = kept.with_suffix(".sweep.toml")
    _write(file, _sweep_toml({"scene": scene, **keys}))
    return file, kept


def _text_of(scene: Scene) -> str:
    try:
        return scene.toml()
    except ValueError as error:
        raise ValueError(
            f"{error}; sweep takes its name (register_scene) or file, and values in grid={{'set': ...}}") from None


def _write(file: Path, toml: str) -> None:
    """Whole or not at all, and over no file of the user's."""
    text = f"{_WRITTEN}, which writes it again for another sweep.\n{toml}"
    if file.exists():
        if (said := file.read_text(encoding="utf-8")) == text:
            return
        if not said.startswith(_WRITTEN):
            raise ValueError(f"{file} exists and was not written by orthant.sweep: results must have another name")
    temporary = Path(f"{file}.tmp{os.getpid()}")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, file)


def _sweep_toml(keys: dict[str, Any]) -> str:
    lists = {key: [value] if isinstance(value, dict) else value for key, value in keys.items()
             if key in ("grid", "figure", "animation")}
    for kind, tables in lists.items():
        if not isinstance(tables, (list, tuple)) or not all(isinstance(table, dict) for table in tables):
            raise TypeError(f"{kind} = {shown(tables)}: must be a dict or a list of dicts")
    lines = toml_lines({key: value for key, value in keys.items() if key not in lists})
    for kind, tables in lists.items():
        for table in tables:
            lines += ["", f"[[{kind}]]"] + toml_lines(table)
    return "\n".join(lines) + "\n"


class _Bar:
    """Cases done, of how many."""

    def __init__(self, name: str, count: int, shown: bool) -> None:
        self._bar: Any = None
        if shown and importlib.util.find_spec("tqdm"):
            from tqdm.auto import tqdm

            self._bar = tqdm(total=count, desc=name, unit="case")

    def __enter__(self) -> _Bar:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()

    @property
    def shown(self) -> bool:
        return self._bar is not None

    def at(self, done: int) -> None:
        if self._bar is not None:
            self._bar.update(done - self._bar.n)


_FRESH = ("import json, sys; sys.path[:], largest, call = json.loads(sys.argv[1]); from orthant import _orthant; "
          "_orthant._set_largest_input(largest); ")


def _fresh(code: str, largest: int, *call: Any) -> list[str]:
    """A command that runs `code` on `call` in an interpreter without threads, which may fork; files are as large as
    here."""
    return [sys.executable, "-c", _FRESH + code, json.dumps([sys.path, largest, call])]


def _by_processes(file: Path, quick: bool, results: Path, jobs: int, name: str, bar: _Bar) -> None:
    """By a fresh interpreter, which forks one process a case: a crash there is a row, and nothing happens here."""
    command = _fresh("_orthant._run_sweep(*call)", _orthant._largest_input(0), str(file), bool(quick), str(results),
                     int(jobs))
    child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                             stderr=subprocess.PIPE, text=True)
    try:
        while True:
            try:
                _, said = child.communicate(timeout=_LOOK_AGAIN)
                break
            except subprocess.TimeoutExpired:
                if bar.shown:
                    bar.at(len(_orthant._sweep_rows(results, name)))
    except BaseException:  # stopped by hand: what is done stays done
        child.terminate()
        child.wait()
        raise
    _ended(child.returncode, said, results, name, bar)


def _ended(code: int, said: str, results: Path, name: str, bar: _Bar) -> None:
    if bar.shown:
        bar.at(len(_orthant._sweep_rows(results, name)))
    if code != 0:
        raise RuntimeError(f"sweep {name}: {said.strip().splitlines()[-1] if said.strip() else 'ended'} "
                           f"(exit code {code}); called again, it goes on")


def _by_forks(file: Path, quick: bool, results: Path, jobs: int, name: str, bar: _Bar) -> None:
    """By a fork of this process, which has its functions and one thread, and forks one process a case."""
    to_read, to_write = os.pipe()
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.flush()  # or the fork would have the text as well
    with warnings.catch_warnings():  # of Python 3.12 and later, where other threads run: the fork needs none
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child == 0:
        _be_a_fork(to_write, lambda: _orthant._run_sweep(file, quick, results, jobs))
    os.close(to_write)
    said, ended = b"", False
    try:
        while not ended:
            if select.select([to_read], [], [], _LOOK_AGAIN)[0]:
                ended = not (more := os.read(to_read, 65536))
                said += more
            if bar.shown:
                bar.at(len(_orthant._sweep_rows(results, name)))
    except BaseException:  # stopped by hand: what is done stays done
        os.kill(child, signal.SIGTERM)
        os.waitpid(child, 0)
        raise
    finally:
        os.close(to_read)
    _ended(_exit_code(os.waitpid(child, 0)[1]), said.decode(errors="replace"), results, name, bar)


def _exit_code(status: int) -> int:
    return -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)


def _be_a_fork(to_write: int, work: Callable[[], object]) -> NoReturn:
    """Does the work, writes what it raises, and ends without what an interpreter does at its end."""
    code = 1
    try:
        for which in (signal.SIGINT, signal.SIGTERM):
            signal.signal(which, signal.SIG_DFL)
        nothing = os.open(os.devnull, os.O_RDWR)
        for descriptor in (0, 1, 2):
            os.dup2(nothing, descriptor)
        work()
        code = 0
    except BaseException as error:
        os.write(to_write, f"{type(error).__name__}: {error}".encode(errors="replace"))
    finally:
        os._exit(code)


def _run_case(file: Path, quick: bool, key: str, largest: int) -> list[str]:
    """By a fresh interpreter as well: a crash there is a row, and the case's time limit holds."""
    command = _fresh("print(*_orthant._run_case(*call), sep='\\n')", largest, str(file), bool(quick), key)
    run = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if run.returncode != 0:
        raise RuntimeError(
            run.stderr.strip().splitlines()[-1] if run.stderr.strip() else f"ended with code {run.returncode}")
    return run.stdout.splitlines()


def _by_dask(client: Any, file: Path, quick: bool, results: Path, missing: list[str], bar: _Bar) -> None:
    distributed: Any = importlib.import_module("distributed")  # untyped in some versions, typed in others
    ours = isinstance(client, str)
    workers = distributed.Client(client) if ours else client
    try:
        futures = [
            workers.submit(_run_case, file, quick, key, _orthant._largest_input(0), key=f"orthant-{key}", retries=2)
            for key in missing
        ]
        total, done, lost = len(missing), 0, []
        for future in distributed.as_completed(futures):
            if future.status == "finished":
                for row in future.result():
                    _orthant._keep_row(results, row)
                done += 1
                bar.at(done)
            else:
                lost.append(f"{future.key}: {future.exception()!r}")
            future.release()
        if lost:
            raise RuntimeError(
                f"sweep: {len(lost)} of {total} cases were lost, the first: {lost[0]}; called again, it goes on")
    finally:
        if ours:
            workers.close()


def _table(lines: list[str]) -> Any:
    rows = []
    for line in lines:
        row = json.loads(line)
        row.pop("problem", None)  # of a failed step: long; `orthant results --failures` writes it
        parameters = row.pop("parameters", None)
        rows.append({**json.loads(parameters or "{}"), **row})
    if importlib.util.find_spec("pandas") is None:
        return rows
    import pandas

    return pandas.DataFrame(rows)
