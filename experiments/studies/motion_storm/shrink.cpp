#include "experiments/studies/motion_storm/shrink.h"

#include "experiments/studies/motion_storm/scenes.h"

#include <array>
#include <charconv>

namespace orthant::motion_storm {
namespace {

std::variant<Angle, Slide, Span>& alternatives(Coordinate& of) { return of; }
std::variant<spatial::Angle, spatial::Slide, spatial::Span>& alternatives(spatial::Coordinate& of) { return of; }

/// Whether a file writes this contact with the one before it.
bool belongs_to_last(const Contact& contact) {
  const auto* pair = std::get_if<PolygonPolygon>(&contact);
  return pair != nullptr && pair->point != 0;
}
bool belongs_to_last(const spatial::Contact& contact) { return follows_in_set(contact); }

/// Numbers of a body that lose digits or become 0: mass; speeds; what else.
std::vector<double*> speeds_of(Body& b) { return {&b.velocity.x(), &b.velocity.y(), &b.omega}; }
std::vector<double*> speeds_of(spatial::Body& b) {
  return {&b.velocity.x(), &b.velocity.y(), &b.velocity.z(), &b.omega.x(), &b.omega.y(), &b.omega.z()};
}
std::vector<double*> places_of(Body& b) {
  return {&b.mass, &b.inertia, &b.velocity.x(), &b.velocity.y(), &b.omega, &b.position.x(), &b.position.y(), &b.angle};
}
std::vector<double*> places_of(spatial::Body& b) {
  std::vector<double*> all = speeds_of(b);
  all.insert(all.begin(), {&b.mass, &b.position.x(), &b.position.y(), &b.position.z()});
  return all;
}

/// Both bodies of an element stay; numbers above the one that goes move down. False: it goes with it.
template <class Element> bool stays(Element& element, BodyId gone) {
  bool stay = true;
  const auto one = [&](BodyId& b) {
    stay = stay && b != gone;
    b -= b > gone;
  };
  const auto both = [&](auto& of) { std::visit([&](auto& c) { one(c.a), one(c.b); }, alternatives(of)); };
  if constexpr (std::is_same_v<Element, spatial::Gear>) {
    spatial::Coordinate first = element.first, second = element.second;
    both(first), both(second);
    if (stay) element = spatial::Gear(element.name, first, second, element.ratio, element.offset);
  } else if constexpr (requires { element.of; }) {
    both(element.of);
  } else if constexpr (requires { element.gear; }) {
    stay = stays(element.gear, gone);
  } else if constexpr (requires { element.a = 0, element.b = 0; }) {
    one(element.a), one(element.b);
  }
  return stay;
}

template <class Scene> Scene without_body(Scene s, BodyId gone) {
  const auto filter = [&](auto& list) {
    std::erase_if(list, [&](auto& x) { return !std::visit([&](auto& y) { return stays(y, gone); }, x); });
  };
  filter(s.joints), filter(s.contacts), filter(s.springs);
  std::erase_if(s.loads, [&](auto& l) { return l.body == gone; });
  for (auto& l : s.loads) l.body -= l.body > gone;
  if constexpr (std::is_same_v<Scene, spatial::Scene>) {
    std::erase_if(s.frictions, [&](auto& f) { return !stays(f, gone); });
    for (spatial::Collision& c : s.collisions) {
      std::erase_if(c.shapes, [&](spatial::Shape& shape) { return shape.body == gone; });
      for (spatial::Shape& shape : c.shapes) shape.body -= shape.body > gone;
    }
    std::erase_if(s.collisions, [](const spatial::Collision& c) { return c.shapes.size() < 2; });
  }
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

template <class Scene> class Shrinking {
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
      smaller = leave_out(&Scene::collisions) || smaller;
      smaller = leave_out(&Scene::frictions) || smaller;
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
                  auto begin = at, end = at + 1;
                  if constexpr (requires { belongs_to_last(*at); }) {  // the whole set
                    while (begin != all.begin() && belongs_to_last(*begin)) --begin;
                    while (end != all.end() && belongs_to_last(*end)) ++end;
                  }
                  all.erase(begin, end);
                }) ||
                smaller;
    }
    return smaller;
  }

  bool plain() {
    bool smaller = false;
    for (std::size_t i = 0; i < scene_.contacts.size(); ++i) {
      if (belongs_to_last(scene_.contacts[i])) continue;  // has the law of the first: a file names one
      std::size_t end = i + 1;
      while (end < scene_.contacts.size() && belongs_to_last(scene_.contacts[end])) ++end;
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
      for (std::size_t field = 0; field < speeds_of(scene_.bodies[b]).size(); ++field)
        smaller = set([&](Scene& s) -> double& { return *speeds_of(s.bodies[b])[field]; }, 0) || smaller;
      smaller = set([&](Scene& s) -> double& { return s.bodies[b].mass; }, 1) || smaller;
    }
    for (Eigen::Index axis = 0; axis < scene_.gravity.size(); ++axis)
      smaller = set([&](Scene& s) -> double& { return s.gravity[axis]; }, 0) || smaller;
    return smaller;
  }

  void round_off() {
    for (const int decimals : {1, 2, 4}) {
      for (std::size_t b = 0; b < scene_.bodies.size(); ++b)
        for (std::size_t field = 0; field < places_of(scene_.bodies[b]).size(); ++field) {
          const auto at = [&](Scene& s) -> double& { return *places_of(s.bodies[b])[field]; };
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
  return Shrinking<Scene>(std::move(scene), shows, tries).least();
}
spatial::Scene shrink(spatial::Scene scene, const std::function<bool(const spatial::Scene&)>& shows, int tries) {
  return Shrinking<spatial::Scene>(std::move(scene), shows, tries).least();
}

}  // namespace orthant::motion_storm
