// Arrays of NumPy that own their memory.
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

/// Returns an array that owns the numbers.
///   shape  its product is the number of scalars in `values`
template <class Scalar, class Value>
[[nodiscard]] nb::object arrayOf(std::vector<Value> values,
                                 std::initializer_list<std::size_t> shape) {
  auto owned = std::make_unique<std::vector<Value>>(std::move(values));
  // A pointer that is not null also for an array without elements.
  static Scalar none{};
  auto* const data = owned->empty() ? &none : reinterpret_cast<Scalar*>(owned->data());
  nb::capsule owner(owned.get(),
                    [](void* p) noexcept { delete static_cast<std::vector<Value>*>(p); });
  (void)owned.release();
  return nb::cast(nb::ndarray<nb::numpy, Scalar>(data, shape, owner));
}

template <class Scalar>
[[nodiscard]] nb::object arrayOf(std::vector<Scalar> values) {
  const std::size_t count = values.size();
  return arrayOf<Scalar>(std::move(values), {count});
}

/// Returns an array [n, 3].
template <class Scalar>
[[nodiscard]] nb::object arrayOf(std::vector<glm::vec<3, Scalar, glm::defaultp>> values) {
  static_assert(sizeof(glm::vec<3, Scalar, glm::defaultp>) == 3 * sizeof(Scalar));
  const std::size_t count = values.size();
  return arrayOf<Scalar>(std::move(values), {count, std::size_t{3}});
}

}  // namespace pysherd
