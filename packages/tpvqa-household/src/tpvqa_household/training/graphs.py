"""Modules as graphs for onnxruntime, and what is done to a graph before it ships."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np


def written(
    module: Any,
    inputs: tuple[Any, ...],
    path: Path,
    names: Sequence[str],
    outputs: Sequence[str],
    axes: Mapping[str, Mapping[int, str]],
) -> None:
    """Write a module of torch as a graph.

    Args:
        module: What computes.
        inputs: Tensors to trace it with.
        path: Where to.
        names: Of the inputs.
        outputs: Their names.
        axes: Those whose length may differ, with a name each.
    """
    import torch

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        torch.onnx.export(
            module,
            inputs,
            str(path),
            dynamo=False,
            opset_version=17,
            input_names=list(names),
            output_names=list(outputs),
            dynamic_axes=axes,
        )
    tidy(path)


def tidy(path: Path) -> None:
    """Make a graph quicker and smaller without changing what it computes."""
    import onnx

    model = onnx.load(str(path))
    _merge_padding(model.graph)
    _halve(model.graph)
    onnx.checker.check_model(model)
    onnx.save(model, str(path))


def _merge_padding(graph: Any) -> None:
    """Let convolutions pad by themselves: a separate step makes onnxruntime reorder its memory."""
    from onnx import helper

    pads = {node.output[0]: node for node in graph.node if node.op_type == "Pad"}
    for conv in graph.node:
        pad = pads.get(conv.input[0]) if conv.op_type == "Conv" else None
        if pad is None:
            continue
        # before each of batch, channels, rows and columns, then after each
        amounts = [int(n) for n in _constant(graph, pad.input[1])]
        own = next(a for a in conv.attribute if a.name == "pads")
        if any(own.ints) or any(amounts[i] for i in (0, 1, 4, 5)):
            continue
        conv.attribute.remove(own)
        merged = [amounts[2], amounts[3], amounts[6], amounts[7]]
        conv.attribute.append(helper.make_attribute("pads", merged))
        conv.input[0] = pad.input[0]
    _drop_unused(graph)


def _constant(graph: Any, name: str) -> Any:
    """The value that a part of a graph computes from constants alone."""
    from onnx import helper
    from onnx.reference import ReferenceEvaluator

    made = {output: node for node in graph.node for output in node.output}
    needed: list[Any] = []
    wanted = [name]
    while wanted:
        node = made[wanted.pop()]
        if node not in needed:
            needed.insert(0, node)
            wanted += [other for other in node.input if other]
    ordered = [node for node in graph.node if node in needed]
    output = helper.make_empty_tensor_value_info(name)
    part = helper.make_graph(ordered, "constant", [], [output])
    opset = [helper.make_opsetid("", 17)]
    computed: Any = ReferenceEvaluator(helper.make_model(part, opset_imports=opset)).run(None, {})
    return computed[0]


def _drop_unused(graph: Any) -> None:
    """Remove what no output rests on."""
    wanted = {output.name for output in graph.output}
    kept = []
    for node in reversed(graph.node):
        if wanted.intersection(node.output):
            wanted.update(node.input)
            kept.append(node)
    del graph.node[:]
    graph.node.extend(reversed(kept))


def _halve(graph: Any) -> None:
    """Store large weights as 16-bit floats, widened again when the graph is loaded."""
    from onnx import TensorProto, helper, numpy_helper

    widened = []
    for tensor in graph.initializer:
        if tensor.data_type != TensorProto.FLOAT or len(tensor.raw_data) < 1024:
            continue
        name = tensor.name
        small = numpy_helper.to_array(tensor).astype(np.float16)
        tensor.CopyFrom(numpy_helper.from_array(small, f"{name}/half"))
        widened.append(helper.make_node("Cast", [f"{name}/half"], [name], to=TensorProto.FLOAT))
    for place, node in enumerate(widened):
        graph.node.insert(place, node)
