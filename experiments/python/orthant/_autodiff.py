"""Runs as differentiable functions of PyTorch and JAX."""

from __future__ import annotations

from typing import Any, Callable, Sequence, Union


def _pair(make: Callable[..., Any], of: Union[str, Sequence[str]], wrt: Union[str, Sequence[str]],
          how: dict[str, Any]) -> tuple[int, Callable[[Any], list[float]], Callable[[Any, Any], list[float]]]:
    """The number of columns; their last values of parameters; the gradient of a weighted sum of them."""
    from ._derivatives import _words, vjp
    from ._simulate import simulate

    columns, parameters = _words("of", of), _words("wrt", wrt)

    def value(at: Any) -> list[float]:
        if len(getattr(at, "shape", ())) != 1 or len(at) != len(parameters):
            raise ValueError(f"parameters: must be a vector of {len(parameters)} numbers, those of wrt")
        final = simulate(make(*(float(x) for x in at)), **how).final
        return [final[column] for column in columns]

    def pull(at: Any, weights: Any) -> list[float]:
        scene = make(*(float(x) for x in at))
        found = vjp(scene, dict(zip(columns, (float(w) for w in weights))), parameters, **how)
        return [found.gradient[name] for name in parameters]

    return len(columns), value, pull


def as_torch(make: Callable[..., Any], of: Union[str, Sequence[str]], wrt: Union[str, Sequence[str]],
             **how: Any) -> Callable[[Any], Any]:
    """A function of a tensor of parameter values to the last values of columns of a run, differentiable by PyTorch.

    make: a function of the parameters' values, one each, that returns the scene. of, wrt: columns and parameters as of
    `gradient`; step, duration, ... as of `simulate`. Reverse mode, once a backward pass; second derivatives are
    refused.
    """
    import torch

    _, value, pull = _pair(make, of, wrt, how)

    class Run(torch.autograd.Function):  # type: ignore[misc]
        @staticmethod
        def forward(ctx: Any, parameters: Any) -> Any:
            ctx.save_for_backward(parameters)
            return parameters.new_tensor(value(parameters.detach().cpu().numpy()))

        @staticmethod
        @torch.autograd.function.once_differentiable  # type: ignore[misc]
        def backward(ctx: Any, weights: Any) -> Any:
            (parameters,) = ctx.saved_tensors
            return parameters.new_tensor(pull(parameters.tolist(), weights.tolist()))

    return Run.apply  # type: ignore[no-any-return]


def as_jax(make: Callable[..., Any], of: Union[str, Sequence[str]], wrt: Union[str, Sequence[str]],
           **how: Any) -> Callable[[Any], Any]:
    """The same for JAX, by custom_vjp; `vmap` and `jacrev` make one run after another. Numbers have JAX's precision:
    set jax_enable_x64 for 64 bits."""
    import jax
    import numpy

    columns, value, pull = _pair(make, of, wrt, how)

    def primal(parameters: Any) -> Any:
        shape = jax.ShapeDtypeStruct((columns,), parameters.dtype)
        return jax.pure_callback(lambda p: numpy.asarray(value(p), p.dtype), shape, parameters,
                                 vmap_method="sequential")

    run: Any = jax.custom_vjp(primal)

    def forward(parameters: Any) -> tuple[Any, Any]:
        return run(parameters), parameters

    def backward(parameters: Any, weights: Any) -> tuple[Any]:
        shape = jax.ShapeDtypeStruct(parameters.shape, parameters.dtype)
        return (jax.pure_callback(lambda p, w: numpy.asarray(pull(p, w), p.dtype), shape, parameters, weights,
                                  vmap_method="sequential"),)

    run.defvjp(forward, backward)
    return run  # type: ignore[no-any-return]
