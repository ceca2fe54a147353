"""Without the bars and warnings of transformers, which are for who writes programs with it."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def quiet() -> Iterator[None]:
    """Keep transformers and the hub's client from writing to standard error meanwhile."""
    from huggingface_hub.utils import logging as of_hub
    from transformers.utils import logging

    level, bars = logging.get_verbosity(), logging.is_progress_bar_enabled()
    level_of_hub = of_hub.get_verbosity()
    logging.set_verbosity(logging.CRITICAL)
    of_hub.set_verbosity(of_hub.CRITICAL)
    logging.disable_progress_bar()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.set_verbosity(level)
        of_hub.set_verbosity(level_of_hub)
        if bars:
            logging.enable_progress_bar()
