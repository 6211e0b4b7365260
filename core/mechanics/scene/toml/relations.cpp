// Relations, gears and pulleys of a planar scene file.
#include "reader.h"

#include <orthant/core/mechanics/planar/relation.h>

namespace orthant::scene_file {
namespace {

constexpr const char* kNotZero = "not 0, of a size from 1e-100 to 1e100";

bool within_most(double ratio) {
  const double size = std::abs(ratio);
  return size >= 1 / CoordinateSum::kMost && size <= CoordinateSum::kMost;
}

}  // namespace

std::vector<CoordinateTerm> Reader::terms_of(Fields& f) {
  std::vector<CoordinateTerm> terms;
  each_table(f, "terms", [&](Fields& g) {
    CoordinateTerm term;
    g.maybe("factor", term.factor);
    term.of = coordinate(g);
    terms.push_back(term);
  });
  const toml::node* node = f.find("terms");
  if (node == nullptr) f.fail(f.table(), "missing key \"terms\"");
  try {
    CoordinateSum{terms};
  } catch (const std::invalid_argument& error) {
    f.fail(*node, error.what());
  }
  return terms;
}

/// A distance that starts as 0 has no direction along which a row could act.
void Reader::apart_at_start(const Fields& f, const std::vector<CoordinateTerm>& terms) const {
  for (const CoordinateTerm& term : terms)
    if (std::holds_alternative<Span>(term.of.kind()) && term.of.value(initial_) == 0)
      f.fail(f.table(), "a distance starts as 0: must be > 0, it has no direction there");
}

void Reader::relation(Fields& f, const std::string& name) {
  const auto terms = terms_of(f);
  apart_at_start(f, terms);
  Relation j(name, terms);
  if (!f.maybe("offset", j.offset)) j.offset = j.sum.value(initial_);
  scene_.joint(j);
}

void Reader::gear(Fields& f, const std::string& name) {
  Angle pair;
  double ratio = 0;
  bodies_of(f, pair), f.need("ratio", ratio);
  if (!within_most(ratio)) f.refuse("ratio", *f.table().get("ratio"), kNotZero);
  if (pair.a == pair.b || pair.a == kGround || pair.b == kGround)
    f.refuse("bodies", *f.table().get("bodies"), "two different bodies, neither the ground");
  const std::vector<CoordinateTerm> terms{{1, Angle{kGround, pair.b}}, {-ratio, Angle{kGround, pair.a}}};
  Relation j(name, terms);
  if (!f.maybe("offset", j.offset)) j.offset = j.sum.value(initial_);
  scene_.joint(j);
}

void Reader::relation_limit(Fields& f, const std::string& name) {
  const auto terms = terms_of(f);
  double e = 0, lower = 0, upper = 0;
  f.maybe("e_n", e);
  const bool below = f.maybe("lower", lower), above = f.maybe("upper", upper);
  if (!below && !above) f.fail(f.table(), "missing key \"lower\" or \"upper\"");
  for (const auto& [key, bound] : {std::pair("lower", lower), std::pair("upper", upper)})
    if (!(std::abs(bound) <= CoordinateSum::kMost)) f.refuse(key, *f.table().get(key), "between -1e100 and 1e100");
  if (below && above && lower >= upper)
    f.refuse("lower", *f.table().get("lower"), "less than upper (a joint of type \"relation\" holds the sum)");
  if (below) apart_at_start(f, terms);
  const bool both = below && above;
  if (below) scene_.contact(RelationLimit(name + (both ? "_lower" : ""), terms, Limit::Side::lower, lower, e));
  if (above) scene_.contact(RelationLimit(name + (both ? "_upper" : ""), terms, Limit::Side::upper, upper, e));
}

void Reader::pulley(Fields& f, const std::string& name) {
  Span a, b;
  double length = 0, ratio = 1, e = 0;
  points_of(f, a);
  b.b = a.b, b.point_b = a.point_b, a.b = a.a, a.point_b = a.point_a, a.a = b.a = kGround;
  a.point_a = Vector2d(0, 0);
  if (!f.maybe("pulley_a", a.point_a)) f.miss("pulley_a");
  b.point_a = a.point_a;
  f.maybe("pulley_b", b.point_a);
  f.need("length", length), f.maybe("ratio", ratio), f.maybe("e_n", e);
  if (!(length > 0) || length > CoordinateSum::kMost)
    f.refuse("length", *f.table().get("length"), "> 0, at most 1e100");
  if (!(ratio > 0) || !within_most(ratio)) f.refuse("ratio", *f.table().get("ratio"), "> 0, from 1e-100 to 1e100");
  if (a.b == kGround || b.b == kGround)
    f.refuse("bodies", *f.table().get("bodies"), "two bodies, neither the ground (that is a \"rope\")");
  if (a.b == b.b) f.refuse("bodies", *f.table().get("bodies"), "two different bodies");
  scene_.contact(RelationLimit(name, {{1, a}, {ratio, b}}, Limit::Side::upper, length, e));
}

}  // namespace orthant::scene_file
