"""llama.cpp's own server with a model, till standard input ends: `python serving.py MODEL EYES`."""

import sys

import xllamacpp


def main() -> None:
    """Print the address when it is ready. Without EYES the model takes no pictures."""
    parameters = xllamacpp.CommonParams()
    parameters.model.path = sys.argv[1]
    if sys.argv[2:]:
        parameters.mmproj.path = sys.argv[2]
    parameters.port, parameters.n_ctx, parameters.n_parallel = 0, 8192, 2
    parameters.cpuparams.n_threads = 1
    parameters.warmup = False
    server = xllamacpp.Server(parameters)
    print(server.listening_address, flush=True)
    sys.stdin.read()


if __name__ == "__main__":
    main()
