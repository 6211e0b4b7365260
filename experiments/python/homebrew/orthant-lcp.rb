# Homebrew: brew install --build-from-source --HEAD experiments/python/homebrew/orthant-lcp.rb. Untested but for its syntax.
class OrthantLcp < Formula
  desc "Linear complementarity problems and nonsmooth multibody dynamics"
  license "BSD-3-Clause"
  version "0.1.0"
  head File.expand_path("../../..", __dir__), using: :git

  depends_on "boost" => :build
  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "eigen" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "gmp"
  depends_on "hdf5"
  depends_on "nlopt"
  depends_on "sqlite"
  depends_on "suite-sparse"
  depends_on "tinyxml2"
  depends_on "tomlplusplus"

  def install
    # CLP and Ipopt are under the Eclipse licence, which UMFPACK's GPL does not go with in bottles.
    system "cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DORTHANT_WITH_CLP=OFF", "-DORTHANT_WITH_IPOPT=OFF",
           "-DORTHANT_BUILD_TESTS=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    assert_match "lemke", shell_output("#{bin}/orthant list solvers")
  end
end
