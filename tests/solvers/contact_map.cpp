// Equations of one contact: their generalized derivatives against differences, where the map is smooth.
#include <orthant/solvers/cones/contact_map.h>

#include <orthant/core/support/random.h>

#include <doctest/doctest.h>
#include <Eigen/Dense>

#include <utility>
#include <vector>

using namespace orthant;

namespace {

using Frictions = std::vector<std::pair<int, double>>;  // rows and μ

/// One block: a normal row [lo, ∞) and these frictions.
cones::Blocks block_with(const Frictions& frictions, double lo) {
  Index n = 1;
  Lcp p;
  for (const auto& [rows, mu] : frictions)
    p.friction.push_back({.normal = 0, .first = n, .rows = rows, .mu = mu}), n += rows;
  p.A = DenseMatrix(Eigen::MatrixXd::Identity(n, n)), p.b = Eigen::VectorXd::Zero(n);
  p.lo = Eigen::VectorXd::Constant(n, -kInf), p.hi = Eigen::VectorXd::Constant(n, kInf);
  p.lo[0] = lo;
  cones::Blocks blocks;
  blocks.load(p);
  return blocks;
}

/// (F, [E H]) at x = (z, w).
std::pair<Eigen::VectorXd, Eigen::MatrixXd> map_at(ContactMap map, const cones::Blocks& blocks,
                                                   const Eigen::VectorXd& x) {
  const Index m = blocks[0].rows;
  Eigen::VectorXd F(m);
  Eigen::MatrixXd both(m, 2 * m);
  evaluate_map(map, blocks, blocks[0], x.data(), x.data() + m, 0.7, map == ContactMap::natural ? 0.7 : 1.3, F.data(),
               both.data(), both.data() + m * m);
  return {F, both};
}

/// Largest difference between the given derivatives and central ones; negative: x is next to a kink.
double derivative_error(ContactMap map, const cones::Blocks& blocks, const Eigen::VectorXd& x) {
  constexpr double kStep = 1e-6;
  const auto [F, given] = map_at(map, blocks, x);
  double worst = 0;
  for (Index c = 0; c < x.size(); ++c) {
    const Eigen::VectorXd by = kStep * Eigen::VectorXd::Unit(x.size(), c);
    const Eigen::VectorXd ahead = (map_at(map, blocks, x + by).first - F) / kStep,
                          behind = (F - map_at(map, blocks, x - by).first) / kStep;
    if ((ahead - behind).lpNorm<Eigen::Infinity>() > 1e-3) return -1;
    worst = std::max(worst, ((ahead + behind) / 2 - given.col(c)).lpNorm<Eigen::Infinity>());
  }
  return worst;
}

}  // namespace

TEST_CASE("cones: the derivatives of every contact map are those of differences") {
  Random random(7);
  const std::vector<Frictions> shapes{{}, {{1, 0.5}}, {{2, 0.7}}, {{2, 1.5}}, {{2, 0.3}, {2, 0.05}}};
  for (const ContactMap map :
       {ContactMap::natural, ContactMap::alart_curnier, ContactMap::jean_moreau, ContactMap::fischer_burmeister})
    for (const Frictions& shape : shapes)
      for (const double lo : {0.0, 0.5}) {
        CAPTURE(static_cast<int>(map));
        CAPTURE(shape.size());
        CAPTURE(lo);
        const cones::Blocks blocks = block_with(shape, lo);
        int smooth = 0;
        for (int trial = 0; trial < 200; ++trial) {
          Eigen::VectorXd x(2 * blocks[0].rows);
          for (double& value : x) value = random.normal();
          if (const double error = derivative_error(map, blocks, x); error >= 0) {
            ++smooth;
            CHECK(error <= 1e-4);
          }
        }
        CHECK(smooth >= 190);
      }
}
