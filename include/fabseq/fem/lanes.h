/// \file
/// Several systems side by side in vector registers.
#pragma once

#include <algorithm>
#include <cstddef>
#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace fabseq {

/// Doubles in a vector register of the processor built for.
#if defined(__AVX512F__)
constexpr int native_lanes = 8;
#elif defined(__AVX__)
constexpr int native_lanes = 4;
#else
constexpr int native_lanes = 2;
#endif

/// `Width` doubles (a power of two), one a system, in as few registers as hold them. Arithmetic is lane by
/// lane; an operation is an instruction a register.
template <int Width>
struct Lanes {
  static constexpr int part_width = std::min(Width, native_lanes);
  static constexpr int parts = Width / part_width;
  using Part __attribute__((vector_size(sizeof(double) * part_width))) = double;
  /// The same in memory of any alignment, free to alias doubles.
  using LoosePart
      __attribute__((vector_size(sizeof(double) * part_width), aligned(sizeof(double)), may_alias)) = double;

  Part part[parts];

  [[gnu::always_inline]] static Lanes load(const double* from) {
    Lanes result;
    for (int i = 0; i < parts; ++i)
      result.part[i] = *reinterpret_cast<const LoosePart*>(from + i * part_width);
    return result;
  }
  /// Widens single precision values.
  [[gnu::always_inline]] static Lanes load(const float* from) {
    Lanes result;
    for (int i = 0; i < parts; ++i)
      for (int lane = 0; lane < part_width; ++lane) result.part[i][lane] = from[i * part_width + lane];
    return result;
  }
  [[gnu::always_inline]] static Lanes broadcast(double value) {
    Lanes result;
    for (int i = 0; i < parts; ++i) result.part[i] = Part{} + value;
    return result;
  }
  [[gnu::always_inline]] static Lanes zero() { return broadcast(0.0); }

  [[gnu::always_inline]] void store(double* to) const {
    for (int i = 0; i < parts; ++i) *reinterpret_cast<LoosePart*>(to + i * part_width) = part[i];
  }
  /// store() past the caches, for what is not read again soon; `to` is aligned to a register.
  [[gnu::always_inline]] void stream(double* to) const {
    for (int i = 0; i < parts; ++i) {
#if defined(__AVX512F__)
      if constexpr (part_width == 8) {
        _mm512_stream_pd(to + i * part_width, (__m512d)part[i]);
        continue;
      }
#endif
#if defined(__AVX__)
      if constexpr (part_width == 4) {
        _mm256_stream_pd(to + i * part_width, (__m256d)part[i]);
        continue;
      }
#endif
      *reinterpret_cast<LoosePart*>(to + i * part_width) = part[i];
    }
  }

  [[gnu::always_inline]] Lanes& operator+=(const Lanes& other) {
    for (int i = 0; i < parts; ++i) part[i] += other.part[i];
    return *this;
  }
  [[gnu::always_inline]] Lanes& operator-=(const Lanes& other) {
    for (int i = 0; i < parts; ++i) part[i] -= other.part[i];
    return *this;
  }
  [[gnu::always_inline]] friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
  [[gnu::always_inline]] friend Lanes operator-(Lanes a, const Lanes& b) { return a -= b; }
  [[gnu::always_inline]] friend Lanes operator*(Lanes a, const Lanes& b) {
    for (int i = 0; i < parts; ++i) a.part[i] *= b.part[i];
    return a;
  }
  [[gnu::always_inline]] friend Lanes operator*(Lanes a, double b) {
    for (int i = 0; i < parts; ++i) a.part[i] *= b;
    return a;
  }
  [[gnu::always_inline]] friend Lanes operator/(Lanes a, const Lanes& b) {
    for (int i = 0; i < parts; ++i) a.part[i] /= b.part[i];
    return a;
  }
  [[gnu::always_inline]] double operator[](int lane) const {
    return part[lane / part_width][lane % part_width];
  }
};

/// One system: a plain double.
template <>
struct Lanes<1> {
  double value;

  static Lanes load(const double* from) { return {*from}; }
  static Lanes load(const float* from) { return {*from}; }
  static Lanes broadcast(double value) { return {value}; }
  static Lanes zero() { return {0.0}; }
  void store(double* to) const { *to = value; }
  void stream(double* to) const { *to = value; }

  Lanes& operator+=(const Lanes& other) {
    value += other.value;
    return *this;
  }
  Lanes& operator-=(const Lanes& other) {
    value -= other.value;
    return *this;
  }
  friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
  friend Lanes operator-(Lanes a, const Lanes& b) { return a -= b; }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return {a.value * b.value}; }
  friend Lanes operator*(const Lanes& a, double b) { return {a.value * b}; }
  friend Lanes operator/(const Lanes& a, const Lanes& b) { return {a.value / b.value}; }
  double operator[](int) const { return value; }
};

}  // namespace fabseq
