/// A hash table from 64-bit keys to small values.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

namespace outcrop::meshing {

/// Open addressing with linear probing; keys are never 0. Values move when the table grows.
template <class Value>
class FlatMap {
 public:
  struct Slot {
    std::uint64_t key = 0;
    Value value{};
  };

  /// The key's value; a new one where there was none.
  Value& operator[](std::uint64_t key) {
    if (2 * (size_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[place(key)];
    if (slot.key == 0) {
      slot.key = key;
      ++size_;
    }
    return slot.value;
  }
  [[nodiscard]] const Value* find(std::uint64_t key) const {
    if (slots_.empty()) return nullptr;
    const Slot& slot = slots_[place(key)];
    return slot.key == key ? &slot.value : nullptr;
  }
  void erase(std::uint64_t key) {
    std::size_t hole = place(key);
    if (slots_[hole].key != key) return;
    --size_;
    // Later members of the run move up, unless that would put one before its home.
    for (std::size_t i = hole;;) {
      i = (i + 1) & mask();
      if (slots_[i].key == 0) break;
      if (((i - home(slots_[i].key)) & mask()) < ((i - hole) & mask())) continue;
      slots_[hole] = std::move(slots_[i]);
      hole = i;
    }
    slots_[hole] = {};
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Calls visit(key, value) for each, in an order that only the history of insertions decides.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const Slot& slot : slots_)
      if (slot.key != 0) visit(slot.key, slot.value);
  }
  void clear() {
    if (size_ > 0) std::fill(slots_.begin(), slots_.end(), Slot{});
    size_ = 0;
  }

 private:
  [[nodiscard]] std::size_t mask() const noexcept { return slots_.size() - 1; }
  [[nodiscard]] std::size_t home(std::uint64_t key) const noexcept {
    return (key * 0x9E3779B97F4A7C15ull) >> (64 - std::countr_zero(slots_.size()));
  }
  /// Where the key is, or the free slot where it would be.
  [[nodiscard]] std::size_t place(std::uint64_t key) const noexcept {
    std::size_t i = home(key);
    while (slots_[i].key != 0 && slots_[i].key != key) i = (i + 1) & mask();
    return i;
  }
  void grow() {
    std::vector<Slot> old(slots_.empty() ? 64 : 2 * slots_.size());
    old.swap(slots_);
    for (Slot& slot : old)
      if (slot.key != 0) slots_[place(slot.key)] = std::move(slot);
  }

  std::vector<Slot> slots_;
  std::size_t size_ = 0;
};

}  // namespace outcrop::meshing
