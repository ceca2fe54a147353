"""A VLM behind an endpoint that speaks OpenAI's chat completions: `tpvqa serve-vlm`.

asked      the prompt of a request → the question that is in it
sent       pictures in a request → frames, within bounds
wire       the bodies of requests and replies
spoken     an answer → words with probabilities, as a language model would say it
desk       what waits is taken together; threads that ask the VLM
door       who may ask: addresses and tokens
app        the endpoint
server     the process: socket, signals, a clean end
"""
