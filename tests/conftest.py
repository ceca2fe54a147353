"""What holds for all tests: how long an example takes on a busy machine is no failure."""

import signal
import threading

from hypothesis import HealthCheck, settings

settings.register_profile("tpvqa", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("tpvqa")

# A suite that is started in the background ignores Ctrl-C, and so would the commands it starts.
if threading.current_thread() is threading.main_thread():
    signal.signal(signal.SIGINT, signal.default_int_handler)
