"""Files with something wrong in them: seeded, so that a failure can be had again."""

import re
from random import Random

_TOKEN = re.compile(r"\s+|[()\[\]{}]|[^\s()\[\]{}]+")
_ODD = (
    *(
        "",
        "(",
        ")",
        "()",
        "((",
        "[",
        "]",
        "{",
        "}",
        "{}",
        "- ",
        "-",
        "?",
        "?x",
        ":",
        "::",
        ",",
        "=",
        "|",
    ),
    *(
        "not",
        "and",
        "or",
        "forall",
        "exists",
        "when",
        "imply",
        "either",
        "object",
        "number",
        "define",
    ),
    *(":action", ":effect", ":precondition", ":parameters", ":init", ":goal", ":types", ":derived"),
    *("increase", "total-cost", "(= (total-cost) 1)", "(:metric minimize (total-cost))"),
    *(
        "0",
        "-1",
        "1e999",
        ".nan",
        ".inf",
        "NaN",
        "-Infinity",
        "9" * 50,
        "9" * 5000,
        "0x1",
        "1:30",
        "~",
    ),
    *(
        "null",
        "true",
        "yes",
        "''",
        '"',
        "'",
        "&a",
        "*a",
        "!!int",
        "!!bool",
        "!!python/name:os.system",
    ),
    *(
        "!!binary",
        "!!timestamp",
        "!!set",
        "!!omap",
        "<<",
        "---",
        "...",
        "%YAML 9",
        "2001-99-99",
        ">",
        "#",
    ),
    *(
        "\t",
        "\r",
        "\x00",
        "\x1b[31m",
        "\u2028",
        "\ufeff",
        "é",
        "😀",
        "x" * 3000,
        "[" * 200,
        "(" * 200,
    ),
    *(
        "{x}",
        "{name}",
        "{x.place}",
        "{{",
        "}}",
        "{x.x.x}",
        "a: b: c",
        "? [a]",
        "\\ud800",
        "\\u0000",
    ),
)


def mutant(text: str, seed: int) -> str:
    """A text with one to four things wrong; of every other one, words alone."""
    chance = Random(seed)
    tokens = _TOKEN.findall(text)
    if seed % 2:
        return _with_other_words(tokens, chance)
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(tokens) + 1)
        end = min(len(tokens), at + chance.choice((1, 1, 1, 2, 5, 20)))
        match chance.randrange(8):
            case 0:
                del tokens[at:end]
            case 1:
                tokens[at:at] = tokens[at:end]
            case 2:
                tokens[at:end] = [chance.choice(_ODD)]
            case 3:
                tokens.insert(at, chance.choice(_ODD))
            case 4:
                tokens[at:end] = [chance.choice(tokens or [""])]
            case 5:
                other = chance.randrange(len(tokens) + 1)
                tokens[at:end], tokens[other : other + 1] = (
                    tokens[other : other + 1],
                    tokens[at:end],
                )
            case 6:
                tokens[at:end] = ["(", *tokens[at:end], ")"]
            case _:
                if chance.random() < 0.2:
                    del tokens[at:]
                else:
                    tokens[at:end] = ["".join(tokens[at:end])[::-1]]
    return "".join(tokens)


def _with_other_words(tokens: list[str], chance: Random) -> str:
    """Words are swapped, dropped, doubled, put into a block; brackets stay in balance."""
    words = [at for at, token in enumerate(tokens) if re.match(r"[^\s()\[\]{}]", token)]
    for _ in range(chance.randint(1, 3)):
        at, other = chance.choice(words), chance.choice(words)
        tokens[at] = chance.choice(
            (
                tokens[other],
                tokens[other],
                "",
                f"{tokens[at]} {tokens[other]}",
                f"({tokens[at]})",
                f"({tokens[at]} {tokens[other]})",
                f"(not ({tokens[at]}))",
                chance.choice([odd for odd in _ODD if len(odd) < 100]),
            )
        )
    return "".join(tokens)
