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
  // read or written at every step, where steps are relaxed
  Real* stride;    ///< the last step
  Real* boldness;  ///< by how much of the field the next goes beyond it, see steps.hpp; of shadow rays the visibility
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
  std::uint64_t left = 0;                                            ///< rays whose next sample is out of the region
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

  static std::uint64_t packet_of(std::uint64_t word, std::size_t slot) { return word >> (slot * kPacketLanes) & 0xFFU; }
  static void set_packet_of(std::uint64_t& word, std::size_t slot, std::uint64_t bits) {
    word = (word & ~(std::uint64_t{0xFF} << (slot * kPacketLanes))) | bits << (slot * kPacketLanes);
  }

  /// Takes a packet out: the last one moves into its slot, so that fewer batches are computed.
  void close(std::size_t slot) {
    --slots;
    const std::uint64_t moved_live = packet_of(live, slots);
    const std::uint64_t moved_left = packet_of(left, slots);
    set_packet_of(live, slots, 0);
    set_packet_of(left, slots, 0);
    if (slot == slots) return;
    set_packet_of(live, slot, moved_live);
    set_packet_of(left, slot, moved_left);
    first_ray[slot] = first_ray[slots];
    start[slot] = start[slots];
    Real* const rows[] = {state.ox, state.oy,    state.oz,      state.dx,      state.dy,     state.dz,
                          state.t,  state.t_max, state.epsilon, state.carried, state.stride, state.boldness};
    for (Real* row : rows) {
      __builtin_memcpy(row + slot * kPacketLanes, row + slots * kPacketLanes, kPacketLanes * sizeof(Real));
    }
  }
};

/// Puts a packet's part of a column into its slot. Columns of one value are set once for the whole block instead.
template <class Real>
void load_packet(Real* row, std::size_t slot, const Column<Real>& column, std::size_t first) {
  if (column.values != nullptr) put_packet(row, slot, column.values + first);
}

/// Copies a slot's packet out of a row.
template <class Real>
void take_packet(const Real* row, std::size_t slot, Real* to) {
  __builtin_memcpy(to, row + slot * kPacketLanes, kPacketLanes * sizeof(Real));
}

template <class Real>
Lanes<Real> at(const Column<Real>& column, std::size_t i) {
  return column.values == nullptr ? Lanes<Real>(column.value) : Lanes<Real>::load(column.values + i);
}

template <class Real>
void set_block(Real* row, const Column<Real>& column) {
  if (column.values != nullptr) return;
  for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) Lanes<Real>(column.value).store(row + lane);
}

/// Bit i: does f hold in lane i of the packet that begins at element `first` of some arrays? f takes the index of a batch.
template <class Real, class Function>
std::uint64_t packet_bits(std::size_t first, Function&& f) {
  const std::size_t begin = first / kWidth<Real> * kWidth<Real>;
  std::uint64_t bits = 0;
  for (std::size_t i = begin; i < first + kPacketLanes; i += kWidth<Real>) bits |= f(i).bits() << (i - begin);
  return bits >> (first - begin) & 0xFFU;
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
