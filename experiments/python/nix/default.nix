# Nix: nix-build experiments/python/nix makes the command and the Python package. Untested but for its syntax.
{ pkgs ? import <nixpkgs> { } }:

pkgs.stdenv.mkDerivation {
  pname = "orthant-lcp";
  version = "0.1.0";
  src = pkgs.lib.cleanSource ../../..;
  nativeBuildInputs = with pkgs; [ cmake ninja ];
  buildInputs = with pkgs; [
    eigen
    suitesparse
    nlohmann_json
    tomlplusplus
    hdf5-cpp
    gmp
    boost
    cli11
    sqlite
    nlopt
    tinyxml-2
    python3
    python3Packages.pybind11
  ];
  propagatedBuildInputs = [ pkgs.python3Packages.numpy ];
  # CLP and Ipopt are under the Eclipse licence, which UMFPACK's GPL does not go with in what is passed on.
  cmakeFlags = [
    "-DORTHANT_WITH_CLP=OFF"
    "-DORTHANT_WITH_IPOPT=OFF"
    "-DORTHANT_BUILD_PYTHON=ON"
    "-DORTHANT_BUILD_TESTS=OFF"
    "-DPython_EXECUTABLE=${pkgs.python3}/bin/python3"
  ];
  meta = {
    description = "Linear complementarity problems and nonsmooth multibody dynamics";
    license = pkgs.lib.licenses.bsd3;
    mainProgram = "orthant";
  };
}
