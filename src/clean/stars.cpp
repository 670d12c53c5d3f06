// The faces around vertices, while faces change.
#include "clean/stars.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace sherd {

Stars::Stars(std::vector<CleanFace> faces, std::size_t vertices)
    : faces_(std::move(faces)),
      isThere_(faces_.size(), true),
      first_(vertices + 1, 0),
      inOrder_(3 * faces_.size()),
      list_(vertices, 0) {
  for (const CleanFace& face : faces_) {
    for (int k = 0; k < 3; ++k) ++first_[face.corner[k] + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    for (int k = 0; k < 3; ++k) inOrder_[next[faces_[f].corner[k]]++] = f;
  }
}

std::vector<std::uint32_t> Stars::atEdge(std::uint32_t a, std::uint32_t b) const {
  std::vector<std::uint32_t> found;
  for (const std::uint32_t f : around(a)) {
    if (faces_[f].has(b)) found.push_back(f);
  }
  return found;
}

void Stars::remove(std::uint32_t number) {
  for (int k = 0; k < 3; ++k) forget(faces_[number].corner[k], number);
  isThere_[number] = false;
}

void Stars::setCorners(std::uint32_t number, const glm::uvec3& corner) {
  glm::uvec3& own = faces_[number].corner;
  for (int k = 0; k < 3; ++k) {
    if (own[k] == corner[k]) continue;
    forget(own[k], number);
    listOf(corner[k]).push_back(number);
    own[k] = corner[k];
  }
}

std::uint32_t Stars::addVertex() {
  lists_.emplace_back();
  list_.push_back(static_cast<std::uint32_t>(lists_.size()));
  return static_cast<std::uint32_t>(list_.size() - 1);
}

std::uint32_t Stars::add(const CleanFace& face) {
  const auto number = static_cast<std::uint32_t>(faces_.size());
  faces_.push_back(face);
  isThere_.push_back(true);
  for (int k = 0; k < 3; ++k) listOf(face.corner[k]).push_back(number);
  return number;
}

std::vector<std::uint32_t>& Stars::listOf(std::uint32_t vertex) {
  if (list_[vertex] == 0) {
    const std::span<const std::uint32_t> own = around(vertex);
    lists_.emplace_back(own.begin(), own.end());
    list_[vertex] = static_cast<std::uint32_t>(lists_.size());
  }
  return lists_[list_[vertex] - 1];
}

void Stars::forget(std::uint32_t vertex, std::uint32_t number) {
  std::vector<std::uint32_t>& own = listOf(vertex);
  own.erase(std::find(own.begin(), own.end(), number));
}

}  // namespace sherd
