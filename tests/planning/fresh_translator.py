"""Fast Downward's translator, forked for each task from a process that has only loaded it.

So a translation owes nothing to those before it, and the modules are loaded once. A request is a
line of JSON on standard input: domain, problem, SAS file; the reply is a line: the exit code.
"""

import json
import os
import signal
import sys
import traceback

from fast_downward.translate.main import main
from fast_downward.translate.options import set_options


def translate(domain: str, problem: str, sas: str) -> int:
    """Translate in a child of this process; its exit code is returned, its traceback printed."""
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    code = 1
    try:
        set_options([domain, problem, "--sas-file", sas])
        main()
        code = 0
    except BaseException:  # noqa: BLE001  the child ends here, however it fails
        traceback.print_exc()
    finally:
        os._exit(code)


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it ends with the pipe
    replies = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    for line in sys.stdin:
        print(translate(*json.loads(line)), file=replies, flush=True)
