// core/support/reusable.h — reusable Eigen vectors and matrices: they keep their memory when their size changes.
//
// A time step's problem grows and shrinks with the number of closed contacts. Eigen's own containers free and
// allocate at every change of size; these allocate only when they outgrow the largest size they ever had.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <initializer_list>
#include <new>
#include <utility>
#include <vector>

namespace orthant {

using Index = Eigen::Index;

/// An index of Eigen's as one of the standard library's.
constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// An Eigen expression (a Map) that owns its storage. Behaves like `Plain` in every expression.
/// Assigning an expression of another size resizes first: the expression must not refer to this object then.
template <class Plain> class Reusable : public Eigen::Map<Plain> {
  using Map = Eigen::Map<Plain>;

 public:
  Reusable() : Map(nullptr, Plain::RowsAtCompileTime == 1 ? 1 : 0, Plain::ColsAtCompileTime == 1 ? 1 : 0) {}
  Reusable(const Reusable& other) : Reusable() { *this = other; }
  Reusable(Reusable&& other) noexcept : Reusable() { swap(other); }
  template <class Derived> Reusable(const Eigen::EigenBase<Derived>& other)
      : Reusable() {  // NOLINT: an expression converts, as in Eigen
    resize(other.rows(), other.cols());
    Map::operator=(other.derived());
  }
  Reusable(std::initializer_list<double> values) : Reusable() {
    resize(static_cast<Index>(values.size()));
    Index i = 0;
    for (const double value : values) (*this)[i++] = value;
  }
  ~Reusable() = default;

  Reusable& operator=(const Reusable& other) {
    resize(other.rows(), other.cols());
    Map::operator=(static_cast<const Map&>(other));
    return *this;
  }
  Reusable& operator=(Reusable&& other) noexcept {
    swap(other);
    return *this;
  }
  template <class Derived> Reusable& operator=(const Eigen::EigenBase<Derived>& other) {
    resize(other.rows(), other.cols());
    Map::operator=(other.derived());
    return *this;
  }

  /// New shape, contents unspecified; allocates only beyond the largest size so far.
  void resize(Index rows, Index cols) {
    const auto needed = static_cast<std::size_t>(rows * cols);
    if (needed > storage_.size()) storage_.resize(needed);
    bind(rows, cols);
  }
  void resize(Index size) {
    static_assert(Plain::IsVectorAtCompileTime);
    resize(Plain::RowsAtCompileTime == 1 ? 1 : size, Plain::RowsAtCompileTime == 1 ? size : 1);
  }
  void swap(Reusable& other) noexcept {
    const Index rows = this->rows(), cols = this->cols();
    std::swap(storage_, other.storage_);
    bind(other.rows(), other.cols());
    other.bind(rows, cols);
  }

 private:
  void bind(Index rows, Index cols) noexcept { new (static_cast<Map*>(this)) Map(storage_.data(), rows, cols); }
  std::vector<typename Plain::Scalar> storage_;
};

using Vector = Reusable<Eigen::VectorXd>;
using DenseMatrix = Reusable<Eigen::MatrixXd>;

}  // namespace orthant
