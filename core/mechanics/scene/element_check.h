// core/mechanics/scene/element_check.h — rules for the fields of a scene's elements, in the plane and in space.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/support/options.h>
#include <orthant/core/support/shortened.h>

#include <cmath>
#include <set>
#include <string>
#include <string_view>

namespace orthant {

/// One element of a scene while its fields are examined; the first rule that fails throws.
template <class AnyScene> class ElementCheck {
 public:
  static constexpr double kLeastMass = 1e-300;  // below, 1/m is not a number any more
  static constexpr double kLargest = 1e150;     // its square is a number
  static constexpr double kLargestMu = 1e6;     // steeper than any digits tell from a wall
  static constexpr double kUnit = 1e-12;        // how far from 1 a unit vector's length may be

  ElementCheck(const AnyScene& scene, std::string_view kind, std::size_t index, const std::string& name)
      : scene_(scene), kind_(kind), index_(index), name_(name) {}

  static std::string text(double x) { return orthant::detail::text_of(x); }
  template <class X> static std::string text(const Eigen::MatrixBase<X>& x) {
    std::string all = "(";
    for (Eigen::Index i = 0; i < x.size(); ++i) all += (i > 0 ? ", " : "") + text(x(i));
    return all + ")";
  }

  [[noreturn]] void fail(const std::string& field, const std::string& sentence) const {
    const std::string who = kind_.empty() ? "scene" : kind_ + " \"" + in_one_line(name_) + "\"";
    throw SceneError(who + ": " + sentence, kind_, index_, field);
  }
  template <class Value>
  void require(bool holds, const std::string& field, const Value& value, const std::string& rule) const {
    if (!holds) fail(field, field + " = " + text(value) + ": must be " + rule);
  }

  void finite(const std::string& field, double x) const {
    require(std::isfinite(x), field, x, "finite");
    require(std::abs(x) <= kLargest, field, x, "between " + text(-kLargest) + " and " + text(kLargest));
  }
  template <class X> void finite(const std::string& field, const Eigen::MatrixBase<X>& x) const {
    require(x.allFinite(), field, x, "finite");
    require((x.array().abs() <= kLargest).all(), field, x, "between " + text(-kLargest) + " and " + text(kLargest));
  }
  void within(const std::string& field, double x, double low, double high) const {
    require(x >= low && x <= high, field, x, "in [" + text(low) + ", " + text(high) + "]");
  }
  void not_negative(const std::string& field, double x) const {
    require(std::isfinite(x), field, x, "finite"), require(x >= 0, field, x, ">= 0"), not_too_large(field, x);
  }
  void positive(const std::string& field, double x) const {
    require(std::isfinite(x), field, x, "finite"), require(x > 0, field, x, "> 0"), not_too_large(field, x);
  }
  void not_too_large(const std::string& field, double x) const {
    require(x <= kLargest, field, x, "<= " + text(kLargest));
  }
  void friction(const std::string& field, double mu) const {
    require(!std::isfinite(mu) || mu <= kLargestMu, field, mu, "<= " + text(kLargestMu)), not_negative(field, mu);
  }
  void invertible(const std::string& field, double x) const {
    positive(field, x), require(x >= kLeastMass, field, x, ">= " + text(kLeastMass));
  }
  template <class X> void unit(const std::string& field, const Eigen::MatrixBase<X>& x) const {
    finite(field, x);
    require(std::abs(x.norm() - 1) <= kUnit, field, x, x.size() == 4 ? "a unit quaternion" : "a unit vector");
  }
  void exists(BodyId body) const {
    const auto bodies = static_cast<BodyId>(scene_.bodies.size());
    if (body < kGround || body >= bodies)
      fail("body", "body " + std::to_string(body) + " does not exist (the scene has " + std::to_string(bodies) +
                       (bodies == 1 ? " body)" : " bodies)"));
  }
  void pair(BodyId a, BodyId b) const {
    exists(a), exists(b);
    if (a != b) return;
    const std::string same =
        a == kGround ? "the ground" : "body \"" + scene_.bodies[static_cast<std::size_t>(a)].name + "\"";
    fail("bodies", "joins " + same + " to itself: must be two different bodies");
  }

 protected:
  const AnyScene& scene_;
  std::string kind_;
  std::size_t index_;
  std::string name_;
};

/// Names address elements ("contact.corner1.mu"), so each must be there, be plain, and be the only one of its kind.
class ElementNames {
 public:
  template <class Element> void add(const Element& element, const std::string& name) {
    constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
    if (name.empty() || name.find_first_not_of(plain) != std::string::npos)
      element.fail("name", "name = \"" + name + "\": must be of letters, digits, _ and -");
    if (!taken_.insert(name).second) element.fail("name", "name = \"" + name + "\": must be distinct, is taken");
  }

 private:
  std::set<std::string> taken_;
};

}  // namespace orthant
