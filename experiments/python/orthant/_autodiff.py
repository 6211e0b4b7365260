"""Runs as differentiable functions of PyTorch and JAX."""

from __future__ import annotations

from typing import Any, Callable, Sequence, Union

from ._spec import shown

_Parts = tuple[int, Callable[[Any], list[float]], Callable[[Any, Any], list[float]], Callable[[Any, bool], None]]


def _pair(make: Callable[..., Any], of: Union[str, Sequence[str]], wrt: Union[str, Sequence[str]],
          how: dict[str, Any]) -> _Parts:
    """The number of columns; their last values of parameters; the gradient of a weighted sum of them; what refuses
    vectors that are no parameters."""
    from ._derivatives import _settings, _words, vjp
    from ._simulate import simulate

    if not callable(make):
        raise TypeError(f"make = {shown(make)}: must be a function of the parameters' values that returns a scene")
    columns, parameters = _words("of", of), _words("wrt", wrt)
    for what, names in (("of", columns), ("wrt", parameters)):
        if twice := [name for place, name in enumerate(names) if name in names[:place]]:
            raise ValueError(f"{what}: {shown(twice[0])} is there twice: must be different names")
    _settings(how)

    def value(at: Any) -> list[float]:
        final = simulate(make(*(float(x) for x in at)), **how).final
        return [final[column] for column in columns]

    def pull(at: Any, weights: Any) -> list[float]:
        scene = make(*(float(x) for x in at))
        found = vjp(scene, dict(zip(columns, (float(w) for w in weights))), parameters, **how)
        return [found.gradient[name] for name in parameters]

    def check(at: Any, floating: bool) -> None:
        if tuple(at.shape) != (len(parameters),):
            raise ValueError(f"parameters: must be a vector of {len(parameters)} numbers, those of wrt; "
                             f"has the shape {tuple(at.shape)}")
        if not floating:
            raise TypeError(f"parameters: must be real numbers in floating point, such as float64; are {at.dtype}")

    return len(columns), value, pull, check


def _absent(module: str, function: str, name: str) -> ModuleNotFoundError:
    return ModuleNotFoundError(f"orthant.{function} needs {name}: pip install {module}", name=module)


def as_torch(make: Callable[..., Any], of: Union[str, Sequence[str]], wrt: Union[str, Sequence[str]],
             **how: Any) -> Callable[[Any], Any]:
    """A function of a tensor of parameter values to the last values of columns of a run, differentiable by PyTorch.

    make: a function of the parameters' values, one each, that returns the scene. of, wrt: columns and parameters as of
    `gradient`; step, duration, ... as of `simulate`. Reverse mode, once a backward pass; second derivatives are
    refused.
    """
    try:
        import torch
    except ModuleNotFoundError as missing:
        raise _absent("torch", "as_torch", "PyTorch") from missing
    _, value, pull, check = _pair(make, of, wrt, how)

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

    def run(parameters: Any) -> Any:
        if not isinstance(parameters, torch.Tensor):
            raise TypeError(f"parameters = {shown(parameters)}: must be a torch.Tensor")
        check(parameters, parameters.is_floating_point())
        return Run.apply(parameters)

    return run


def as_jax(make: Callable[..., Any], of: Union[str, Sequence[str]], wrt: Union[str, Sequence[str]],
           **how: Any) -> Callable[[Any], Any]:
    """The same for JAX, by custom_vjp; `vmap` and `jacrev` make one run after another. Numbers have JAX's precision:
    set jax_enable_x64 for 64 bits."""
    try:
        import jax
    except ModuleNotFoundError as missing:
        raise _absent("jax", "as_jax", "JAX") from missing
    import numpy

    columns, value, pull, check = _pair(make, of, wrt, how)

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

    def checked(parameters: Any) -> Any:
        if not hasattr(parameters, "shape") or not hasattr(parameters, "dtype"):
            raise TypeError(f"parameters = {shown(parameters)}: must be a JAX array")
        check(parameters, jax.numpy.issubdtype(parameters.dtype, jax.numpy.floating))
        return run(parameters)

    return checked
