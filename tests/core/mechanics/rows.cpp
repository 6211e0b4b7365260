// The verbs of rows and blocks against the dense Jacobian that they stand for.
#include <orthant/core/mechanics/rows.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

constexpr int kBodies = 4;

Eigen::VectorXd numbers(int seed) {
  Eigen::VectorXd x(kBlock * kBodies);
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = std::sin(1.0 + seed + 7.0 * static_cast<double>(i));
  return x;
}

Row row_of(BodyId a, BodyId b, int seed) {
  const Eigen::VectorXd x = numbers(seed);
  return {a, b, {x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
}

Eigen::VectorXd dense(const Row& row) {
  Eigen::VectorXd j = Eigen::VectorXd::Zero(kBlock * kBodies);
  for (int k = 0; k < kBlock; ++k) {
    if (row.a != kGround) j[kBlock * row.a + k] += row.ja[static_cast<std::size_t>(k)];
    if (row.b != kGround) j[kBlock * row.b + k] += row.jb[static_cast<std::size_t>(k)];
  }
  return j;
}

bool same(const Eigen::VectorXd& x, const Eigen::VectorXd& y) { return (x - y).lpNorm<Eigen::Infinity>() < 1e-14; }

const Row kRows[] = {row_of(0, 2, 0), row_of(3, 1, 2), row_of(2, kGround, 3), row_of(kGround, 1, 4), row_of(2, 0, 5)};

}  // namespace

TEST_CASE("a row's products are those of its dense Jacobian, with the ground and bodies in either order") {
  const Eigen::VectorXd v = numbers(10), masses = numbers(11).cwiseAbs();
  for (const Row& row : kRows) {
    const Eigen::VectorXd j = dense(row);
    CHECK(std::abs(apply(row, v.data()) - j.dot(v)) < 1e-14);
    Eigen::VectorXd f = v, moved = v;
    apply_transposed(row, 0.7, f.data()), apply_impulse(row, 0.7, masses, moved);
    CHECK(same(f, v + 0.7 * j));
    CHECK(same(moved, v + 0.7 * masses.cwiseProduct(j)));
    for (const Row& other : kRows)
      CHECK(std::abs(coupling(row, other, masses) - j.dot(masses.cwiseProduct(dense(other)))) < 1e-14);
  }
}

TEST_CASE("rows scale, combine, add up and become sparse as their dense Jacobians do") {
  for (const Row& row : kRows) {
    const Eigen::VectorXd j = dense(row);
    CHECK(same(dense(scaled(row, -2.5)), -2.5 * j));
    CHECK(zero(blank(row)));
    CHECK_FALSE(zero(row));
    CHECK(same_bodies(row, blank(row)));
    const Row other = row_of(row.a, row.b, 20);
    CHECK(same(dense(combined(row, 0.3, other)), j + 0.3 * dense(other)));
    Row turned = row_of(row.b, row.a, 21);
    const Eigen::VectorXd before = dense(turned);
    add_to(turned, 0.3, row);
    CHECK(same(dense(turned), before + 0.3 * j));

    std::vector<int> place;
    std::vector<double> value;
    append_to(place, value, row);
    CHECK(std::is_sorted(place.begin(), place.end()));
    Eigen::VectorXd sparse = Eigen::VectorXd::Zero(j.size()), entries = sparse;
    for (std::size_t k = 0; k < place.size(); ++k) sparse[place[k]] += value[k];
    each_entry(row, [&](Eigen::Index i, double entry) { entries[i] += entry; });
    CHECK(same(sparse, j));
    CHECK(same(entries, j));
  }
  CHECK_FALSE(same_bodies(kRows[0], kRows[4]));
  CHECK(push_on(kRows[0], 0) == Vector2d(kRows[0].ja[0], kRows[0].ja[1]));
  CHECK(push_on(kRows[0], 2) == Vector2d(kRows[0].jb[0], kRows[0].jb[1]));
}

TEST_CASE("the reach of a row bounds its rate, and is attained when no terms cancel") {
  Eigen::VectorXd v = numbers(12);
  for (const Row& row : kRows) {
    const auto bound = [&](BodyId body) { return largest_translation(v, body); };
    CHECK(std::abs(apply(row, v.data())) <= reach(row, v, bound) * (1 + 1e-15));
    Eigen::VectorXd along = dense(row).cwiseSign();
    CHECK(std::abs(apply(row, along.data()) - reach(row, along, [](BodyId) { return 1.0; })) < 1e-14);
  }
}

TEST_CASE("blocks: translation and rotation of a body, sizes, and a step from one pose to another") {
  Eigen::VectorXd q(6);
  q << 1, -2, 0.5, 3, 4, -6;
  CHECK(translation(q, 1) == Vector2d(3, 4));
  CHECK(rotation(q, 1) == -6);
  CHECK(largest_translation(q, 1) == 4);
  CHECK(largest_entry(q, 1) == 6);
  CHECK(largest_entry(q, 0) == 2);
  CHECK(largest_motion(q, 0) == doctest::Approx(std::sqrt(5.0)).epsilon(1e-15));
  CHECK(largest_rotation(q) == 6);
  CHECK(body_of_entry(5) == 1);
  CHECK(is_rotation(5));
  CHECK_FALSE(is_rotation(3));
  Eigen::VectorXd there, step = numbers(3).head(6);
  move(q, 0.1 * step, there);
  CHECK(same(between(q, there), 0.1 * step));
  move(q, between(q, there));
  CHECK(same(q, there));
  block(q, 0).setZero();
  rotation(q, 1) = 2;
  CHECK(q.head<3>().isZero());
  CHECK(q[5] == 2);
}
