// Arrays of NumPy that keep their memory.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace pysherd {

namespace nb = nanobind;

/// Returns an array of the numbers, which it keeps; they are not copied.
///   shape  its product is the number of scalars in `values`
template <class Scalar, class Value>
[[nodiscard]] nb::object arrayOf(const std::shared_ptr<std::vector<Value>>& values,
                                 std::initializer_list<std::size_t> shape) {
  using Kept = std::shared_ptr<std::vector<Value>>;
  // A pointer that is not null also for an array without elements.
  static Scalar none{};
  auto* const data = values->empty() ? &none : reinterpret_cast<Scalar*>(values->data());
  auto kept = std::make_unique<Kept>(values);
  nb::capsule owner(kept.get(), [](void* p) noexcept { delete static_cast<Kept*>(p); });
  (void)kept.release();
  return nb::cast(nb::ndarray<nb::numpy, Scalar>(data, shape, owner));
}

/// Returns an array that owns the numbers.
template <class Scalar, class Value>
[[nodiscard]] nb::object arrayOf(std::vector<Value> values,
                                 std::initializer_list<std::size_t> shape) {
  return arrayOf<Scalar>(std::make_shared<std::vector<Value>>(std::move(values)), shape);
}

template <class Scalar>
[[nodiscard]] nb::object arrayOf(std::vector<Scalar> values) {
  const std::size_t count = values.size();
  return arrayOf<Scalar>(std::move(values), {count});
}

/// Returns an array [n, 3].
template <class Scalar>
using Vectors = std::vector<glm::vec<3, Scalar, glm::defaultp>>;

template <class Scalar>
[[nodiscard]] nb::object arrayOf(const std::shared_ptr<Vectors<Scalar>>& values) {
  static_assert(sizeof(glm::vec<3, Scalar, glm::defaultp>) == 3 * sizeof(Scalar));
  return arrayOf<Scalar>(values, {values->size(), std::size_t{3}});
}

template <class Scalar>
[[nodiscard]] nb::object arrayOf(std::vector<glm::vec<3, Scalar, glm::defaultp>> values) {
  return arrayOf<Scalar>(std::make_shared<Vectors<Scalar>>(std::move(values)));
}

}  // namespace pysherd
