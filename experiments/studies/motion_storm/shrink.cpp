#include "experiments/studies/motion_storm/shrink.h"

#include <array>
#include <charconv>

namespace orthant::motion_storm {
namespace {

/// Both bodies of an element stay; numbers above the one that goes move down. False: it goes with it.
template <class Element> bool stays(Element& element, BodyId gone) {
  bool stay = true;
  const auto one = [&](BodyId& b) {
    stay = stay && b != gone;
    b -= b > gone;
  };
  if constexpr (requires { element.of; })
    std::visit([&](auto& c) { one(c.a), one(c.b); }, static_cast<std::variant<Angle, Slide, Span>&>(element.of));
  else if constexpr (requires { element.a = 0, element.b = 0; })
    one(element.a), one(element.b);
  return stay;
}

Scene without_body(Scene s, BodyId gone) {
  const auto filter = [&](auto& list) {
    std::erase_if(list, [&](auto& x) { return !std::visit([&](auto& y) { return stays(y, gone); }, x); });
  };
  filter(s.joints), filter(s.contacts), filter(s.springs);
  std::erase_if(s.loads, [&](Load& l) { return l.body == gone; });
  for (Load& l : s.loads) l.body -= l.body > gone;
  s.bodies.erase(s.bodies.begin() + gone);
  return s;
}

/// The nearest number of so many decimal digits.
double digits(double value, int decimals) {
  std::array<char, 40> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, decimals - 1).ptr;
  double rounded = value;
  std::from_chars(text.data(), end, rounded);
  return rounded;
}

class Shrinking {
 public:
  Shrinking(Scene scene, const std::function<bool(const Scene&)>& shows, int tries)
      : scene_(std::move(scene)), shows_(shows), left_(tries) {}

  Scene least() {
    for (bool smaller = true; smaller && left_ > 0;) {
      smaller = false;
      for (auto b = static_cast<BodyId>(scene_.bodies.size()); b-- > 0 && scene_.bodies.size() > 1;)
        smaller = take(without_body(scene_, b)) || smaller;
      smaller = leave_out(&Scene::contacts) || smaller;
      smaller = leave_out(&Scene::joints) || smaller;
      smaller = leave_out(&Scene::springs) || smaller;
      smaller = leave_out(&Scene::loads) || smaller;
      smaller = change([](Scene& s) { s.duration /= 2; }) || smaller;
      smaller = plain() || smaller;
    }
    round_off();
    return scene_;
  }

 private:
  bool take(Scene candidate) {
    if (left_-- <= 0) return false;
    try {
      check(candidate);
    } catch (const std::invalid_argument&) {
      return false;
    }
    if (!shows_(candidate)) return false;
    scene_ = std::move(candidate);
    return true;
  }
  template <class How> bool change(How&& how) {
    Scene candidate = scene_;
    how(candidate);
    return take(std::move(candidate));
  }
  /// To `simple`, if it is not that already.
  template <class Field> bool set(Field&& field, double simple) {
    if (field(scene_) == simple) return false;
    return change([&](Scene& s) { field(s) = simple; });
  }

  template <class List> bool leave_out(List Scene::*list) {
    bool smaller = false;
    for (std::size_t i = (scene_.*list).size(); i-- > 0;) {
      if (i >= (scene_.*list).size()) continue;
      smaller = change([&](Scene& s) {
                  auto& all = s.*list;
                  const auto at = all.begin() + static_cast<std::ptrdiff_t>(i);
                  if constexpr (std::is_same_v<List, std::vector<Contact>>)
                    if (std::holds_alternative<PolygonPolygon>(*at)) {  // both points
                      const auto& pair = std::get<PolygonPolygon>(*at);
                      const auto begin = pair.point == 0 ? at : at - 1;
                      all.erase(begin, std::min(begin + 2, all.end()));
                      return;
                    }
                  all.erase(at);
                }) ||
                smaller;
    }
    return smaller;
  }

  bool plain() {
    bool smaller = false;
    for (std::size_t i = 0; i < scene_.contacts.size(); ++i) {
      const auto* pair = std::get_if<PolygonPolygon>(&scene_.contacts[i]);
      if (pair != nullptr && pair->point != 0) continue;  // has the law of the first: a file names one
      const std::size_t end = i + (pair != nullptr ? 2 : 1);
      const auto law = [](Scene& s, std::size_t k) -> ContactLaw* {
        return std::visit(
            [](auto& c) -> ContactLaw* {
              if constexpr (requires { c.law.mu = 0; })
                return &c.law;
              else
                return nullptr;
            },
            s.contacts[k]);
      };
      const auto none = [&](double ContactLaw::*field) {
        if (law(scene_, i)->*field == 0) return;
        smaller = change([&](Scene& s) {
                    for (std::size_t k = i; k < std::min(end, s.contacts.size()); ++k) law(s, k)->*field = 0;
                  }) ||
                  smaller;
      };
      if (law(scene_, i) == nullptr) continue;
      none(&ContactLaw::mu_static);
      if (law(scene_, i)->mu_static == 0) none(&ContactLaw::mu);
      none(&ContactLaw::e);
    }
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      smaller = set([&](Scene& s) -> double& { return s.bodies[b].velocity.x(); }, 0) || smaller;
      smaller = set([&](Scene& s) -> double& { return s.bodies[b].velocity.y(); }, 0) || smaller;
      smaller = set([&](Scene& s) -> double& { return s.bodies[b].omega; }, 0) || smaller;
      smaller = set([&](Scene& s) -> double& { return s.bodies[b].mass; }, 1) || smaller;
    }
    smaller = set([](Scene& s) -> double& { return s.gravity.x(); }, 0) || smaller;
    return set([](Scene& s) -> double& { return s.gravity.y(); }, 0) || smaller;
  }

  void round_off() {
    for (const int decimals : {1, 2, 4}) {
      for (std::size_t b = 0; b < scene_.bodies.size(); ++b)
        for (const int field : {0, 1, 2, 3, 4, 5, 6, 7}) {
          const auto at = [&](Scene& s) -> double& {
            Body& body = s.bodies[b];
            double* all[] = {&body.mass,  &body.inertia,      &body.velocity.x(), &body.velocity.y(),
                             &body.omega, &body.position.x(), &body.position.y(), &body.angle};
            return *all[field];
          };
          set(at, digits(at(scene_), decimals));
        }
      set([](Scene& s) -> double& { return s.duration; }, digits(scene_.duration, decimals));
      set([](Scene& s) -> double& { return s.step; }, digits(scene_.step, decimals));
    }
  }

  Scene scene_;
  const std::function<bool(const Scene&)>& shows_;
  int left_;
};

}  // namespace

Scene shrink(Scene scene, const std::function<bool(const Scene&)>& shows, int tries) {
  return Shrinking(std::move(scene), shows, tries).least();
}

}  // namespace orthant::motion_storm
