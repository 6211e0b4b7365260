// core/mechanics/planar/custom_joint.h — user-defined joint: a struct of the same shape as Revolute,
// handed to Scene::joint().
//
//   struct Mine {
//     static constexpr int kRows = 1;                                        // Φ = 0 has so many rows
//     std::string name;
//     BodyId a, b;                                                           // one of them may be kGround
//     void residual(const Kinematics& k, double* phi) const;                 // Φ [m, rad]
//     void rows(const Kinematics& k, Row* G) const;                          // ∂Φ/∂q
//     void bias(const Kinematics& k, double* Gdot_v) const;                  // Ġ v − s̈ [m/s²]
//     void rate(const Kinematics& k, double* wanted) const;                  // ṡ, of a joint driven in time only
//     std::string wrong(const Kinematics& start) const;                      // optional: custom_check.h
//   };
//   scene.joint(Mine{"mine", a, b, …});
//
// check(scene) compares rows, rate and bias with differences of residual and rows (derivatives.h). A custom joint costs
// an indirect call where a built-in one costs a branch; a scene without one costs nothing more. Jumps of a drive's s̈
// are not reported as breakpoints: integrators with error control find them, the others detect them at the ends of
// their steps.
#pragma once

#include <orthant/core/mechanics/planar/coordinate.h>
#include <orthant/core/mechanics/planar/custom_check.h>

#include <algorithm>
#include <concepts>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

namespace orthant {

template <class T>
concept JointKind = requires(const T& joint, const Kinematics& k, double* x, Row* G) {
  { T::kRows } -> std::convertible_to<int>;
  bodies_of(joint), joint.residual(k, x), joint.rows(k, G), joint.bias(k, x);
  { joint.name } -> std::convertible_to<std::string>;
};

class CustomJoint {
 public:
  std::string name;
  BodyId a = kGround, b = kGround;

  template <JointKind T> CustomJoint(T joint)  // NOLINT(google-explicit-constructor): any joint is one
      : name(joint.name), kind_(std::make_shared<const Of<T>>(std::move(joint))) {
    std::tie(a, b) = kind_->bodies();
  }

  int row_count() const { return kind_->row_count(); }
  bool driven() const { return kind_->driven(); }
  /// See custom_check.h.
  std::optional<std::string> own_check(const Kinematics& start) const { return kind_->own_check(start); }
  /// The joint that this was made of; null: of another type.
  template <class T> const T* target() const {
    const auto* of = dynamic_cast<const Of<T>*>(kind_.get());
    return of != nullptr ? &of->joint_ : nullptr;
  }
  void residual(const Kinematics& k, double* phi) const { kind_->residual(k, phi); }
  void rows(const Kinematics& k, Row* G) const { kind_->rows(k, G); }
  void rate(const Kinematics& k, double* wanted) const { kind_->rate(k, wanted); }
  void bias(const Kinematics& k, double* Gdot_v) const { kind_->bias(k, Gdot_v); }

 private:
  struct Kind {
    virtual ~Kind() = default;
    virtual std::pair<BodyId, BodyId> bodies() const = 0;
    virtual int row_count() const = 0;
    virtual bool driven() const = 0;
    virtual std::optional<std::string> own_check(const Kinematics& start) const = 0;
    virtual void residual(const Kinematics& k, double* phi) const = 0;
    virtual void rows(const Kinematics& k, Row* G) const = 0;
    virtual void rate(const Kinematics& k, double* wanted) const = 0;
    virtual void bias(const Kinematics& k, double* Gdot_v) const = 0;
  };
  template <class T> struct Of final : Kind {
    static constexpr bool kDriven = requires(const T& joint, const Kinematics& k, double* x) { joint.rate(k, x); };
    explicit Of(T joint) : joint_(std::move(joint)) {}
    std::pair<BodyId, BodyId> bodies() const override { return bodies_of(joint_); }
    int row_count() const override { return T::kRows; }
    bool driven() const override { return kDriven; }
    std::optional<std::string> own_check(const Kinematics& start) const override {
      return orthant::own_check(joint_, start);
    }
    void residual(const Kinematics& k, double* phi) const override { joint_.residual(k, phi); }
    void rows(const Kinematics& k, Row* G) const override { joint_.rows(k, G); }
    void rate(const Kinematics& k, double* wanted) const override {
      if constexpr (kDriven)
        joint_.rate(k, wanted);
      else
        std::fill_n(wanted, T::kRows, 0.0);
    }
    void bias(const Kinematics& k, double* Gdot_v) const override { joint_.bias(k, Gdot_v); }
    T joint_;
  };
  std::shared_ptr<const Kind> kind_;  // scenes are copied freely, and nobody changes a joint
};

}  // namespace orthant
