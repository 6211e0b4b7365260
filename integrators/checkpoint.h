// integrators/checkpoint.h — checkpoint of an integrator: its state between steps, in binary; one list for both ways.
//
//   void Scheme::remember(CheckpointData& memory) { memory(last_step_, modes_, formulation_); }
//   CheckpointData out;  scheme.remember(out);  out.bytes()     the doubles' own bits: reading returns the same numbers
//   CheckpointData in(bytes);  other.remember(in);  in.end()    throws std::invalid_argument where they do not fit
//
//   Numbers, enumerations, structs of them, strings, vectors of all these, and any type with a remember(). The bytes
//   are valid on this machine only: a checkpoint continues a run and is not an archive format.
#pragma once

#include <orthant/core/lcp/solution.h>
#include <orthant/core/mechanics/dynamics/state.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace orthant {

class CheckpointData {
 public:
  CheckpointData() = default;
  explicit CheckpointData(std::string_view bytes) : reading_(true), left_(bytes) {}

  bool reading() const { return reading_; }
  const std::string& bytes() const { return bytes_; }

  template <class... Items> void operator()(Items&... items) { (item(items), ...); }

  /// All must have been read.
  void end() const {
    if (!left_.empty()) refuse();
  }

 private:
  [[noreturn]] static void refuse() {
    throw std::invalid_argument("checkpoint: is cut off, or of another scene, integrator or build");
  }

  void raw(void* data, std::size_t size) {
    if (!reading_) {
      bytes_.append(static_cast<const char*>(data), size);
      return;
    }
    if (size > left_.size()) refuse();
    if (size > 0) std::memcpy(data, left_.data(), size);
    left_.remove_prefix(size);
  }
  /// Of a list; every entry takes a byte at least, so no list is longer than what is left.
  std::size_t count(std::size_t now) {
    auto size = static_cast<std::uint64_t>(now);
    raw(&size, sizeof size);
    if (reading_ && size > left_.size()) refuse();
    return static_cast<std::size_t>(size);
  }

  template <class T> void item(T& x) {
    if constexpr (requires(T & y, CheckpointData & memory) { y.remember(memory); }) {
      x.remember(*this);
    } else {
      static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
      raw(&x, sizeof x);
    }
  }
  template <class T> void item(std::vector<T>& x) {
    x.resize(count(x.size()));
    for (T& each : x) item(each);
  }
  void item(std::string& x) {
    x.resize(count(x.size()));
    raw(x.data(), x.size());
  }
  template <class V> void numbers(V& x) {
    const std::size_t size = count(static_cast<std::size_t>(x.size()));
    if (reading_ && size > left_.size() / sizeof(double)) refuse();
    x.resize(static_cast<Index>(size));
    raw(x.data(), size * sizeof(double));
  }
  void item(Eigen::VectorXd& x) { numbers(x); }
  void item(Vector& x) { numbers(x); }
  void item(State& x) { (*this)(x.t, x.q, x.v); }

  bool reading_ = false;
  std::string bytes_;
  std::string_view left_;
};

}  // namespace orthant
