// SPDX-License-Identifier: MIT
/// \file
/// Several systems side by side in vector registers.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace fabseq {

/// Bytes of a vector register of the processor built for.
#if defined(__AVX512F__)
constexpr int register_bytes = 64;
#elif defined(__AVX__)
constexpr int register_bytes = 32;
#else
constexpr int register_bytes = 16;
#endif
/// Doubles in it.
constexpr int native_lanes = register_bytes / static_cast<int>(sizeof(double));

/// `Width` numbers (a power of two), one per system, in as few registers as hold them. Arithmetic is lane by
/// lane; an operation is one instruction per register. `Real`: double or float.
template <int Width, class Real = double>
struct Lanes {
  static constexpr int width = Width;
  static constexpr int part_width = std::min(Width, register_bytes / static_cast<int>(sizeof(Real)));
  static constexpr int parts = Width / part_width;
  using Part __attribute__((vector_size(sizeof(Real) * part_width))) = Real;

  Part part[parts];

  /// Loads from memory of any alignment, doubles or floats.
  template <class From>
  [[gnu::always_inline]] static Lanes load(const From* from) {
    Lanes result;
    for (int i = 0; i < parts; ++i)
      result.part[i] =
          converted<From, Real>(*reinterpret_cast<const LoosePart<From>*>(from + i * part_width));
    return result;
  }
  [[gnu::always_inline]] static Lanes broadcast(Real value) {
    Lanes result;
    for (int i = 0; i < parts; ++i) result.part[i] = Part{} + value;
    return result;
  }
  [[gnu::always_inline]] static Lanes zero() { return broadcast(Real{0}); }

  /// Stores to memory of any alignment, doubles or floats.
  template <class To>
  [[gnu::always_inline]] void store(To* to) const {
    for (int i = 0; i < parts; ++i)
      *reinterpret_cast<LoosePart<To>*>(to + i * part_width) = converted<Real, To>(part[i]);
  }
  /// store() past the caches, for what is not read again soon; `to` is aligned to a register.
  [[gnu::always_inline]] void stream(Real* to) const {
    for (int i = 0; i < parts; ++i) {
#if defined(__AVX512F__)
      if constexpr (sizeof(Part) == 64) {
        _mm512_stream_pd(reinterpret_cast<double*>(to + i * part_width), (__m512d)part[i]);
        continue;
      }
#endif
#if defined(__AVX__)
      if constexpr (sizeof(Part) == 32) {
        _mm256_stream_pd(reinterpret_cast<double*>(to + i * part_width), (__m256d)part[i]);
        continue;
      }
#endif
      *reinterpret_cast<LoosePart<Real>*>(to + i * part_width) = part[i];
    }
  }

  [[gnu::always_inline]] Lanes& operator+=(const Lanes& other) {
    for (int i = 0; i < parts; ++i) part[i] += other.part[i];
    return *this;
  }
  [[gnu::always_inline]] friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
  [[gnu::always_inline]] friend Lanes operator-(Lanes a, const Lanes& b) {
    for (int i = 0; i < parts; ++i) a.part[i] -= b.part[i];
    return a;
  }
  [[gnu::always_inline]] friend Lanes operator*(Lanes a, const Lanes& b) {
    for (int i = 0; i < parts; ++i) a.part[i] *= b.part[i];
    return a;
  }
  [[gnu::always_inline]] friend Lanes operator*(Lanes a, Real b) {
    for (int i = 0; i < parts; ++i) a.part[i] *= b;
    return a;
  }
  [[gnu::always_inline]] friend Lanes operator/(Lanes a, const Lanes& b) {
    for (int i = 0; i < parts; ++i) a.part[i] /= b.part[i];
    return a;
  }
  [[gnu::always_inline]] Real operator[](int lane) const {
    return part[lane / part_width][lane % part_width];
  }

 private:
  template <class Other>
  using PartOf __attribute__((vector_size(sizeof(Other) * part_width))) = Other;
  /// Part in memory of any alignment, free to alias its numbers.
  template <class Other>
  using LoosePart
      __attribute__((vector_size(sizeof(Other) * part_width), aligned(sizeof(Other)), may_alias)) = Other;
  /// One instruction between eight floats and eight doubles, which GCC 12 makes four. Without a mask, its
  /// intrinsics warn of a value that is not set.
  template <class From, class To>
  [[gnu::always_inline]] static PartOf<To> converted(PartOf<From> from) {
#if defined(__AVX512F__)
    if constexpr (part_width == 8 && sizeof(From) < sizeof(To))
      return (PartOf<To>)_mm512_maskz_cvtps_pd(0xFF, (__m256)from);
    else if constexpr (part_width == 8 && sizeof(From) > sizeof(To))
      return (PartOf<To>)_mm512_maskz_cvtpd_ps(0xFF, (__m512d)from);
    else
#endif
      return __builtin_convertvector(from, PartOf<To>);
  }
};

/// One system: a plain number.
template <class Real>
struct Lanes<1, Real> {
  static constexpr int width = 1;

  Real value;

  template <class From>
  static Lanes load(const From* from) {
    return {static_cast<Real>(*from)};
  }
  static Lanes broadcast(Real value) { return {value}; }
  static Lanes zero() { return {Real{0}}; }
  template <class To>
  void store(To* to) const {
    *to = static_cast<To>(value);
  }
  void stream(Real* to) const { *to = value; }

  Lanes& operator+=(const Lanes& other) {
    value += other.value;
    return *this;
  }
  friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
  friend Lanes operator-(const Lanes& a, const Lanes& b) { return {a.value - b.value}; }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return {a.value * b.value}; }
  friend Lanes operator*(const Lanes& a, Real b) { return {a.value * b}; }
  friend Lanes operator/(const Lanes& a, const Lanes& b) { return {a.value / b.value}; }
  Real operator[](int) const { return value; }
};

/// The larger of two numbers, lane by lane.
template <int Width, class Real>
[[gnu::always_inline]] inline Lanes<Width, Real> larger(const Lanes<Width, Real>& a,
                                                        const Lanes<Width, Real>& b) {
  Lanes<Width, Real> result;
  if constexpr (Width == 1)
    result.value = std::max(a.value, b.value);
  else
    for (int i = 0; i < Lanes<Width, Real>::parts; ++i)
      result.part[i] = a.part[i] > b.part[i] ? a.part[i] : b.part[i];
  return result;
}

/// 1 in lanes with a positive number, 0 in others.
template <int Width>
[[gnu::always_inline]] inline Lanes<Width> is_positive(const Lanes<Width>& a) {
  Lanes<Width> result;
  if constexpr (Width == 1)
    result.value = a.value > 0.0 ? 1.0 : 0.0;
  else
    for (int i = 0; i < Lanes<Width>::parts; ++i)
      result.part[i] = a.part[i] > 0.0 ? Lanes<Width>::broadcast(1.0).part[i] : Lanes<Width>::zero().part[i];
  return result;
}

/// Square roots, lane by lane.
template <int Width>
[[gnu::always_inline]] inline Lanes<Width> root(const Lanes<Width>& a) {
  alignas(register_bytes) std::array<double, Width> values;
  a.store(values.data());
  for (double& value : values) value = __builtin_sqrt(value);
  return Lanes<Width>::load(values.data());
}

/// `Width` lanes of two registers behind each other, from lane `First` on; in one register.
template <int Width, int First, int Each, class Real>
[[gnu::always_inline]] inline Lanes<Width, Real> lanes_from(const Lanes<Each, Real>& before,
                                                            const Lanes<Each, Real>& behind) {
  if constexpr (Width == 1) {
    return {before.part[0][First]};
  } else if constexpr (Each == 1) {
    Lanes<2, Real> result;
    result.part[0] = typename Lanes<2, Real>::Part{before.value, behind.value};
    return result;
  } else {
    return [&]<int... Lane>(std::integer_sequence<int, Lane...>) __attribute__((always_inline)) {
      Lanes<Width, Real> result;
      result.part[0] = __builtin_shufflevector(before.part[0], behind.part[0], (First + Lane)...);
      return result;
    }
    (std::make_integer_sequence<int, Width>());
  }
}

/// Numbers `which`, `which` + 2 ... of `Count` pairs in memory; in one register.
template <int Count, class Real>
[[gnu::always_inline]] inline Lanes<Count, Real> of_pairs(const Real* pairs, int which) {
  if constexpr (Count == 1) {
    return {pairs[which]};
  } else {
    const auto first = Lanes<Count, Real>::load(pairs), second = Lanes<Count, Real>::load(pairs + Count);
    return [&]<int... Pair>(std::integer_sequence<int, Pair...>) __attribute__((always_inline)) {
      Lanes<Count, Real> result;
      result.part[0] = which == 0 ? __builtin_shufflevector(first.part[0], second.part[0], (2 * Pair)...)
                                  : __builtin_shufflevector(first.part[0], second.part[0], (2 * Pair + 1)...);
      return result;
    }
    (std::make_integer_sequence<int, Count>());
  }
}

/// The lanes of one, then those of the other; in one register.
template <int Width, class Real>
[[gnu::always_inline]] inline Lanes<2 * Width, Real> joined(const Lanes<Width, Real>& first,
                                                            const Lanes<Width, Real>& second) {
  return lanes_from<2 * Width, 0>(first, second);
}

/// Register of `Count` pieces, piece k being piece(k): lanes of the same width.
template <int Count, class Piece>
[[gnu::always_inline]] inline auto joined_pieces(Piece&& piece, int first = 0) {
  if constexpr (Count == 1)
    return piece(first);
  else
    return joined(joined_pieces<Count / 2>(piece, first), joined_pieces<Count / 2>(piece, first + Count / 2));
}

/// Returns the lanes in double precision.
template <int Width, class Real>
[[gnu::always_inline]] inline Lanes<Width> widened(const Lanes<Width, Real>& lanes) {
  if constexpr (sizeof(Real) == sizeof(double)) {
    return lanes;
  } else {
    alignas(register_bytes) std::array<Real, Width> values;
    lanes.store(values.data());
    return Lanes<Width>::load(values.data());
  }
}

/// Adds lanes of several nodes, one node's after the other's, in double precision.
template <int Width, int Wider, class Real>
[[gnu::always_inline]] inline void add_up(const Lanes<Wider, Real>& nodes, Lanes<Width>& sum) {
  if constexpr (Wider == Width) {
    sum += widened(nodes);
  } else {
    alignas(register_bytes) std::array<Real, Wider> values;
    nodes.store(values.data());
    for (int first = 0; first < Wider; first += Width) sum += Lanes<Width>::load(values.data() + first);
  }
}

/// Swaps the upper lanes of pairs in one row with the lower ones in another: a step of transposed().
template <int Apart, int Width, class Part>
[[gnu::always_inline]] inline void swap_lanes(Part& upper, Part& lower) {
  [&]<int... Lane>(std::integer_sequence<int, Lane...>) __attribute__((always_inline)) {
    const Part a = upper, b = lower;
    upper = __builtin_shufflevector(a, b, ((Lane & Apart) != 0 ? Width + Lane - Apart : Lane)...);
    lower = __builtin_shufflevector(a, b, ((Lane & Apart) != 0 ? Width + Lane : Lane + Apart)...);
  }
  (std::make_integer_sequence<int, Width>());
}

/// Rows as columns: lane j of row i becomes lane i of row j.
template <int Width, class Real>
[[gnu::always_inline]] inline std::array<Lanes<Width, Real>, Width> transposed(
    std::array<Lanes<Width, Real>, Width> rows) {
  using Row = Lanes<Width, Real>;
  constexpr int each = Row::part_width;
  const auto step = [&]<int Apart>() __attribute__((always_inline)) {
    for (int row = 0; row < Width; ++row)
      if ((row & Apart) == 0)
        for (int i = 0; i < Row::parts; ++i)
          swap_lanes<Apart, each>(rows[row].part[i], rows[row + Apart].part[i]);
  };
  if constexpr (each > 1) step.template operator()<1>();
  if constexpr (each > 2) step.template operator()<2>();
  if constexpr (each > 4) step.template operator()<4>();
  // Squares of whole registers.
  for (int row = 0; row < Width; ++row)
    for (int i = row / each + 1; i < Row::parts; ++i)
      std::swap(rows[row].part[i], rows[i * each + row % each].part[row / each]);
  return rows;
}

/// Covers `lanes` by chunks of 8, 4, 2 and 1, as few as possible: calls `use(first)`, with the width as its
/// template argument, for the first lane of each.
template <class Use>
void for_lane_chunks(int lanes, Use&& use) {
  int first = 0;
  for (; lanes - first >= 8; first += 8) use.template operator()<8>(first);
  if (lanes - first >= 4) {
    use.template operator()<4>(first);
    first += 4;
  }
  if (lanes - first >= 2) {
    use.template operator()<2>(first);
    first += 2;
  }
  if (lanes - first >= 1) use.template operator()<1>(first);
}

}  // namespace fabseq
