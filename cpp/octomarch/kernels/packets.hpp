// The state of a march: packets of rays in the slots of a block, with their way in. Rows are read and written in whole
// batches. tasks.hpp and march.hpp work on it.
#pragma once

#include <limits>

#include "octomarch/kernels/api.hpp"
#include "octomarch/kernels/lanes.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// State of the rays in a block, one row of kLanes per quantity, in the memory of a march (see kMarchRows).
template <class Real>
struct BlockState {
  // read or written at every step
  Real* dx;
  Real* dy;
  Real* dz;
  Real* t;
  Real* carried;  ///< what the task remembers: the last accepted r, or a visibility
  // often one value for all rays, and then only written
  Real* ox;
  Real* oy;
  Real* oz;
  Real* t_max;
  Real* epsilon;
};

/// A block: its rays, and for each of its packets which rays they are and when they came.
template <class Real>
struct Block {
  BlockState<Real> state;
  std::size_t first_ray[kPackets] = {};
  std::int64_t start[kPackets] = {};                                 ///< value of `step` at which each packet came
  std::int64_t step = 0;                                             ///< steps made so far
  std::int64_t deadline = std::numeric_limits<std::int64_t>::max();  ///< value of `step` at which a packet is spent
  std::uint64_t live = 0;                                            ///< rays that go on; bit = lane
  std::size_t slots = 0;                                             ///< packets held, in the first slots
  Real* registers = nullptr;                                         ///< a register file of its own

  std::uint64_t used_lanes() const {
    return slots == kPackets ? ~std::uint64_t{0} : (std::uint64_t{1} << (slots * kPacketLanes)) - 1;
  }

  /// Does a packet have no live ray left? (The zero-byte test of H. S. Warren, "Hacker's Delight", 2nd ed., 6-1.)
  bool any_ended() const {
    const std::uint64_t w = live | ~used_lanes();
    return ((w - 0x0101010101010101ULL) & ~w & 0x8080808080808080ULL) != 0;
  }

  void set_live(std::size_t slot, std::uint64_t bits) {
    live = (live & ~(std::uint64_t{0xFF} << (slot * kPacketLanes))) | bits << (slot * kPacketLanes);
  }

  /// Takes a packet out: the last one moves into its slot, so that fewer batches are computed.
  void close(std::size_t slot) {
    --slots;
    const std::uint64_t moved = live >> (slots * kPacketLanes) & 0xFFU;
    set_live(slots, 0);
    if (slot == slots) return;
    set_live(slot, moved);
    first_ray[slot] = first_ray[slots];
    start[slot] = start[slots];
    Real* const rows[] = {state.ox, state.oy, state.oz,    state.dx,      state.dy,
                          state.dz, state.t,  state.t_max, state.epsilon, state.carried};
    for (Real* row : rows) {
      __builtin_memcpy(row + slot * kPacketLanes, row + slots * kPacketLanes, kPacketLanes * sizeof(Real));
    }
  }
};

/// Copies the first `valid` lanes of a packet, all of them in the common case by moves of known size.
template <class T>
void copy_packet(T* to, const T* from, std::size_t valid) {
  if (valid == kPacketLanes) {
    __builtin_memcpy(to, from, kPacketLanes * sizeof(T));
  } else {
    for (std::size_t lane = 0; lane < valid; ++lane) to[lane] = from[lane];
  }
}

/// Puts a packet's part of a column into its slot, lanes past the end repeating its first. Columns of one value are set
/// once for the whole block instead.
template <class Real>
void load_packet(Real* row, std::size_t slot, const Column<Real>& column, std::size_t first, std::size_t valid) {
  if (column.values == nullptr) return;
  const Real* const from = column.values + first;
  if (valid == kPacketLanes) {
    put_packet(row, slot, from);
  } else {
    for (std::size_t lane = 0; lane < kPacketLanes; ++lane)
      row[slot * kPacketLanes + lane] = from[lane < valid ? lane : 0];
  }
}

template <class Real>
void set_block(Real* row, const Column<Real>& column) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) row[lane] = column.value;
}

/// The first lane of the batches that hold a packet; where a batch is wider than a packet it holds others too.
template <class Real>
constexpr std::size_t first_batch_lane(std::size_t slot) {
  return slot * kPacketLanes / kWidth<Real> * kWidth<Real>;
}

/// The lanes of a batch that belong to a slot's packet.
template <class Real>
Mask<Real> packet_mask(std::size_t lane, std::size_t slot) {
  alignas(kAlignment) static constexpr auto kLaneNumbers = [] {
    struct {
      Real value[kLanes];
    } numbers{};
    for (std::size_t i = 0; i < kLanes; ++i) numbers.value[i] = static_cast<Real>(i);
    return numbers;
  }();
  const Lanes<Real> number = Lanes<Real>::load(kLaneNumbers.value + lane);
  const auto begin = static_cast<Real>(slot * kPacketLanes);
  return (number >= Lanes<Real>(begin)) & (number < Lanes<Real>(begin + Real(kPacketLanes)));
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
