/// Sets of a brick's 9³ nodes, one bit each.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "outcrop/core/vec.h"

namespace outcrop::meshing {

inline constexpr int kBrickCells = 8;
inline constexpr int kBrickNodes = kBrickCells + 1;
inline constexpr int kNodes = kBrickNodes * kBrickNodes * kBrickNodes;
/// From a node to the next along each axis, in a brick's arrays of 9³ values.
inline constexpr int kStride[3] = {1, kBrickNodes, kBrickNodes * kBrickNodes};

/// Where node i + 9 j + 81 k is in its brick: (i, j, k).
[[nodiscard]] inline IVec3 node_place(int node) noexcept {
  struct Place {
    std::uint8_t x, y, z;
  };
  static constexpr auto kPlaces = [] {
    std::array<Place, kNodes> places{};
    for (int n = 0; n < kNodes; ++n)
      places[n] = {static_cast<std::uint8_t>(n % 9), static_cast<std::uint8_t>(n / 9 % 9),
                   static_cast<std::uint8_t>(n / 81)};
    return places;
  }();
  const Place& place = kPlaces[node];
  return {place.x, place.y, place.z};
}

/// Bit i + 9 j + 81 k stands for node (i, j, k), or for an edge or a cell that starts there.
class NodeSet {
 public:
  void insert(int node) noexcept { words_[node / 64] |= std::uint64_t{1} << node % 64; }
  /// The same from flags that are 0 or 1, kWords · 64 of them.
  static NodeSet of(const std::uint8_t* flags) noexcept {
    NodeSet set;
    for (int word = 0; word < kWords; ++word)
      for (int byte = 0; byte < 8; ++byte) {
        // Gathers the lowest bits of eight bytes in the highest byte.
        std::uint64_t eight;
        std::memcpy(&eight, flags + 64 * word + 8 * byte, sizeof eight);
        set.words_[word] |= (eight * 0x0102040810204080u >> 56) << 8 * byte;
      }
    return set;
  }
  /// Bits `node` to `node` + 31.
  [[nodiscard]] std::uint32_t from(int node) const noexcept {
    const int word = node / 64, shift = node % 64;
    return static_cast<std::uint32_t>(words_[word] >> shift | words_[word + 1] << 1 << (63 - shift));
  }
  /// The nodes from which `by` nodes further there is one of this set; 0 < by < 128.
  [[nodiscard]] NodeSet before(int by) const noexcept {
    NodeSet set;
    for (int word = 0; word < kWords; ++word) {
      const int low = word + by / 64;
      if (low >= kWords) break;
      set.words_[word] = words_[low] >> by % 64 | words_[low + 1] << 1 << (63 - by % 64);
    }
    return set;
  }
  [[nodiscard]] bool empty() const noexcept { return *this == NodeSet{}; }
  /// Calls visit(node) for each, in order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (int word = 0; word < kWords; ++word)
      for (std::uint64_t bits = words_[word]; bits != 0; bits &= bits - 1) visit(64 * word + std::countr_zero(bits));
  }

  friend NodeSet operator&(NodeSet a, const NodeSet& b) noexcept {
    return a.combine(b, [](auto x, auto y) { return x & y; });
  }
  friend NodeSet operator|(NodeSet a, const NodeSet& b) noexcept {
    return a.combine(b, [](auto x, auto y) { return x | y; });
  }
  friend NodeSet operator^(NodeSet a, const NodeSet& b) noexcept {
    return a.combine(b, [](auto x, auto y) { return x ^ y; });
  }
  friend bool operator==(const NodeSet& a, const NodeSet& b) noexcept = default;

  static constexpr int kWords = (kNodes + 63) / 64;

 private:
  template <class Operation>
  NodeSet& combine(const NodeSet& b, Operation&& operation) noexcept {
    for (int word = 0; word < kWords; ++word) words_[word] = operation(words_[word], b.words_[word]);
    return *this;
  }

  std::array<std::uint64_t, kWords + 1> words_{};  ///< And one word of zeros.
};

/// What a brick that may be cut short by the lattice's end has of 9³.
struct BrickShape {
  NodeSet nodes, cells;
  std::array<NodeSet, 3> edges;  ///< By axis.

  explicit BrickShape(const IVec3& size) noexcept;
  /// That of 8³ cells.
  [[nodiscard]] static const BrickShape& whole() noexcept;
};

}  // namespace outcrop::meshing
