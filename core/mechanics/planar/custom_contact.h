// core/mechanics/planar/custom_contact.h — user-defined contact: a struct of the same shape as CornerWall,
// handed to Scene::contact().
//
//   struct Mine {
//     std::string name;
//     BodyId a, b;                                          // the normal points from b to a; one may be kGround
//     ContactLaw law;
//     double gap(const Kinematics& k) const;                // [m] > 0: open
//     ContactRows rows(const Kinematics& k) const;          // ġ and slip as rows of velocities
//     ContactBias bias(const Kinematics& k) const;          // d/dt of both at zero acceleration [m/s²]
//     double length() const;                                // [m] optional, see below
//     std::string wrong(const Kinematics& start) const;     // optional: custom_check.h
//   };
//   scene.contact(Mine{"mine", a, b, {.mu = 0.3}, …});
//
// check(scene) compares rows and bias with differences of gap and rows (derivatives.h). length(): how far the bodies
// may move against each other before the gap's course is another one, a radius or so; integrators that search for
// contacts along a long step test the gap at this spacing, and at each half radian of turning. Absent: only turning
// counts. There is no warning of steps in which thin bodies pass through each other (integrators/step/tunnelling.h
// covers the built-in shapes only).
#pragma once

#include <orthant/core/mechanics/planar/contact_law.h>
#include <orthant/core/mechanics/planar/coordinate.h>
#include <orthant/core/mechanics/planar/custom_check.h>

#include <concepts>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

namespace orthant {

template <class T>
concept ContactKind = requires(const T& contact, const Kinematics& k) {
  bodies_of(contact);
  { contact.gap(k) } -> std::convertible_to<double>;
  { contact.rows(k) } -> std::same_as<ContactRows>;
  { contact.bias(k) } -> std::same_as<ContactBias>;
  { contact.law } -> std::convertible_to<ContactLaw>;
  { contact.name } -> std::convertible_to<std::string>;
};

class CustomContact {
 public:
  std::string name;
  BodyId a = kGround, b = kGround;
  ContactLaw law;

  template <ContactKind T> CustomContact(T contact)  // NOLINT(google-explicit-constructor): any contact is one
      : name(contact.name), law(contact.law), kind_(std::make_shared<const Of<T>>(std::move(contact))) {
    std::tie(a, b) = kind_->bodies();
  }

  double gap(const Kinematics& k) const { return kind_->gap(k); }
  ContactRows rows(const Kinematics& k) const { return kind_->rows(k); }
  ContactBias bias(const Kinematics& k) const { return kind_->bias(k); }
  double length() const { return kind_->length(); }
  /// See custom_check.h.
  std::optional<std::string> own_check(const Kinematics& start) const { return kind_->own_check(start); }
  /// The contact that this was made of; null: of another type.
  template <class T> const T* target() const {
    const auto* of = dynamic_cast<const Of<T>*>(kind_.get());
    return of != nullptr ? &of->contact_ : nullptr;
  }

 private:
  struct Kind {
    virtual ~Kind() = default;
    virtual std::pair<BodyId, BodyId> bodies() const = 0;
    virtual double gap(const Kinematics& k) const = 0;
    virtual ContactRows rows(const Kinematics& k) const = 0;
    virtual ContactBias bias(const Kinematics& k) const = 0;
    virtual double length() const = 0;
    virtual std::optional<std::string> own_check(const Kinematics& start) const = 0;
  };
  template <class T> struct Of final : Kind {
    explicit Of(T contact) : contact_(std::move(contact)) {}
    std::pair<BodyId, BodyId> bodies() const override { return bodies_of(contact_); }
    double gap(const Kinematics& k) const override { return contact_.gap(k); }
    ContactRows rows(const Kinematics& k) const override { return contact_.rows(k); }
    ContactBias bias(const Kinematics& k) const override { return contact_.bias(k); }
    double length() const override {
      if constexpr (requires { contact_.length(); })
        return contact_.length();
      else
        return std::numeric_limits<double>::infinity();
    }
    std::optional<std::string> own_check(const Kinematics& start) const override {
      return orthant::own_check(contact_, start);
    }
    T contact_;
  };
  std::shared_ptr<const Kind> kind_;  // scenes are copied freely, and nobody changes a contact
};

}  // namespace orthant
