import signal
import threading

import pytest


@pytest.fixture
def ctrl_c():
    """Soon, as a terminal would send it; a shell's background jobs, which ignore it, are told not to."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield lambda: threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    signal.signal(signal.SIGINT, before)
