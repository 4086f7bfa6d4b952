// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE4_1__)
#include <smmintrin.h>
#endif

/// The few vector operations that the extractor needs: 32 lanes of 8 bits or 16 lanes of 16 bits.
///
/// With AVX2 each is one or two instructions, with SSE4.1 (x86-64-v2) twice as many. Elsewhere they
/// are loops over arrays. All give the same results, bit for bit. (OpenCV's universal intrinsics,
/// outside OpenCV itself, stop at SSE2 and know no byte shuffle and no 8-bit multiply-add.)
namespace ydd::simd {

inline constexpr int kLanes8 = 32;

// What one instruction set means by a name must not be linked for another one's.
#if defined(__AVX2__)
inline namespace avx2 {

inline constexpr const char* kInstructionSet = "AVX2";

struct U8 {
  __m256i v;
};
struct I16 {
  __m256i v;
};

inline U8 load(const std::uint8_t* p) {
  return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))};
}
/// 16 bytes from `low` and 16 from `high`.
inline U8 load_halves(const std::uint8_t* low, const std::uint8_t* high) {
  const __m128i a = _mm_loadu_si128(reinterpret_cast<const __m128i*>(low));
  const __m128i b = _mm_loadu_si128(reinterpret_cast<const __m128i*>(high));
  return {_mm256_inserti128_si256(_mm256_castsi128_si256(a), b, 1)};
}
inline void store(std::uint8_t* p, U8 a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a.v);
}
inline U8 splat8(int x) { return {_mm256_set1_epi8(static_cast<char>(x))}; }
inline U8 min(U8 a, U8 b) { return {_mm256_min_epu8(a.v, b.v)}; }
inline U8 max(U8 a, U8 b) { return {_mm256_max_epu8(a.v, b.v)}; }
/// (a + b + 1) / 2
inline U8 average(U8 a, U8 b) { return {_mm256_avg_epu8(a.v, b.v)}; }
/// max(a - b, 0)
inline U8 subtract(U8 a, U8 b) { return {_mm256_subs_epu8(a.v, b.v)}; }
/// min(a + b, 255)
inline U8 add(U8 a, U8 b) { return {_mm256_adds_epu8(a.v, b.v)}; }
inline U8 bit_and(U8 a, U8 b) { return {_mm256_and_si256(a.v, b.v)}; }
inline U8 bit_or(U8 a, U8 b) { return {_mm256_or_si256(a.v, b.v)}; }
inline bool any(U8 a) { return _mm256_testz_si256(a.v, a.v) == 0; }
/// Lanes all ones where a >= b.
inline U8 at_least(U8 a, U8 b) { return {_mm256_cmpeq_epi8(_mm256_max_epu8(a.v, b.v), a.v)}; }
/// Bit i is the top bit of lane i.
inline std::uint32_t top_bits(U8 a) {
  return static_cast<std::uint32_t>(_mm256_movemask_epi8(a.v));
}
/// Within each half of 16: lane i becomes lane index[i] (0 to 15).
inline U8 shuffle_halves(U8 a, U8 index) { return {_mm256_shuffle_epi8(a.v, index.v)}; }
/// Lane i of the result: a[2i] * weight[2i] + a[2i+1] * weight[2i+1], weights signed.
inline I16 dot_pairs(U8 a, U8 weight) { return {_mm256_maddubs_epi16(a.v, weight.v)}; }

inline I16 load(const std::int16_t* p) {
  return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))};
}
inline void store(std::int16_t* p, I16 a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a.v);
}
inline I16 splat16(int x) { return {_mm256_set1_epi16(static_cast<short>(x))}; }
inline I16 add(I16 a, I16 b) { return {_mm256_add_epi16(a.v, b.v)}; }
inline I16 subtract(I16 a, I16 b) { return {_mm256_sub_epi16(a.v, b.v)}; }
inline I16 multiply(I16 a, I16 b) { return {_mm256_mullo_epi16(a.v, b.v)}; }
/// (a * b + 2^14) / 2^15
inline I16 multiply_q15(I16 a, I16 b) { return {_mm256_mulhrs_epi16(a.v, b.v)}; }
template <int bits>
I16 shift_right(I16 a) {
  return {_mm256_srai_epi16(a.v, bits)};
}
inline I16 low_half(U8 a) { return {_mm256_cvtepu8_epi16(_mm256_castsi256_si128(a.v))}; }
inline I16 high_half(U8 a) { return {_mm256_cvtepu8_epi16(_mm256_extracti128_si256(a.v, 1))}; }
/// All 32 lanes in order, limited to 0 to 255.
inline U8 narrow(I16 low, I16 high) {
  return {_mm256_permute4x64_epi64(_mm256_packus_epi16(low.v, high.v), 0b11011000)};
}
/// Sum of the products of all lanes.
inline std::int32_t dot(I16 a, I16 b) {
  const __m256i p = _mm256_madd_epi16(a.v, b.v);
  __m128i s = _mm_add_epi32(_mm256_castsi256_si128(p), _mm256_extracti128_si256(p, 1));
  s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0b01001110));
  s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0b10110001));
  return _mm_cvtsi128_si32(s);
}

}  // namespace avx2
#elif defined(__SSE4_1__)
inline namespace sse41 {

inline constexpr const char* kInstructionSet = "SSE4.1";

struct U8 {
  __m128i low, high;
};
struct I16 {
  __m128i low, high;
};

inline __m128i load16(const void* p) { return _mm_loadu_si128(static_cast<const __m128i*>(p)); }
inline void store16(void* p, __m128i a) { _mm_storeu_si128(static_cast<__m128i*>(p), a); }

inline U8 load(const std::uint8_t* p) { return {load16(p), load16(p + 16)}; }
inline U8 load_halves(const std::uint8_t* low, const std::uint8_t* high) {
  return {load16(low), load16(high)};
}
inline void store(std::uint8_t* p, U8 a) {
  store16(p, a.low);
  store16(p + 16, a.high);
}
inline U8 splat8(int x) {
  const __m128i all = _mm_set1_epi8(static_cast<char>(x));
  return {all, all};
}
inline U8 min(U8 a, U8 b) { return {_mm_min_epu8(a.low, b.low), _mm_min_epu8(a.high, b.high)}; }
inline U8 max(U8 a, U8 b) { return {_mm_max_epu8(a.low, b.low), _mm_max_epu8(a.high, b.high)}; }
inline U8 average(U8 a, U8 b) { return {_mm_avg_epu8(a.low, b.low), _mm_avg_epu8(a.high, b.high)}; }
inline U8 subtract(U8 a, U8 b) {
  return {_mm_subs_epu8(a.low, b.low), _mm_subs_epu8(a.high, b.high)};
}
inline U8 add(U8 a, U8 b) { return {_mm_adds_epu8(a.low, b.low), _mm_adds_epu8(a.high, b.high)}; }
inline U8 bit_and(U8 a, U8 b) {
  return {_mm_and_si128(a.low, b.low), _mm_and_si128(a.high, b.high)};
}
inline U8 bit_or(U8 a, U8 b) { return {_mm_or_si128(a.low, b.low), _mm_or_si128(a.high, b.high)}; }
inline bool any(U8 a) {
  const __m128i joined = _mm_or_si128(a.low, a.high);
  return _mm_testz_si128(joined, joined) == 0;
}
inline U8 at_least(U8 a, U8 b) {
  return {_mm_cmpeq_epi8(_mm_max_epu8(a.low, b.low), a.low),
          _mm_cmpeq_epi8(_mm_max_epu8(a.high, b.high), a.high)};
}
inline std::uint32_t top_bits(U8 a) {
  return static_cast<std::uint32_t>(_mm_movemask_epi8(a.low)) |
         static_cast<std::uint32_t>(_mm_movemask_epi8(a.high)) << 16U;
}
inline U8 shuffle_halves(U8 a, U8 index) {
  return {_mm_shuffle_epi8(a.low, index.low), _mm_shuffle_epi8(a.high, index.high)};
}
inline I16 dot_pairs(U8 a, U8 weight) {
  return {_mm_maddubs_epi16(a.low, weight.low), _mm_maddubs_epi16(a.high, weight.high)};
}

inline I16 load(const std::int16_t* p) { return {load16(p), load16(p + 8)}; }
inline void store(std::int16_t* p, I16 a) {
  store16(p, a.low);
  store16(p + 8, a.high);
}
inline I16 splat16(int x) {
  const __m128i all = _mm_set1_epi16(static_cast<short>(x));
  return {all, all};
}
inline I16 add(I16 a, I16 b) {
  return {_mm_add_epi16(a.low, b.low), _mm_add_epi16(a.high, b.high)};
}
inline I16 subtract(I16 a, I16 b) {
  return {_mm_sub_epi16(a.low, b.low), _mm_sub_epi16(a.high, b.high)};
}
inline I16 multiply(I16 a, I16 b) {
  return {_mm_mullo_epi16(a.low, b.low), _mm_mullo_epi16(a.high, b.high)};
}
inline I16 multiply_q15(I16 a, I16 b) {
  return {_mm_mulhrs_epi16(a.low, b.low), _mm_mulhrs_epi16(a.high, b.high)};
}
template <int bits>
I16 shift_right(I16 a) {
  return {_mm_srai_epi16(a.low, bits), _mm_srai_epi16(a.high, bits)};
}
inline I16 widened(__m128i a) {
  return {_mm_cvtepu8_epi16(a), _mm_cvtepu8_epi16(_mm_srli_si128(a, 8))};
}
inline I16 low_half(U8 a) { return widened(a.low); }
inline I16 high_half(U8 a) { return widened(a.high); }
inline U8 narrow(I16 low, I16 high) {
  return {_mm_packus_epi16(low.low, low.high), _mm_packus_epi16(high.low, high.high)};
}
inline std::int32_t dot(I16 a, I16 b) {
  __m128i s = _mm_add_epi32(_mm_madd_epi16(a.low, b.low), _mm_madd_epi16(a.high, b.high));
  s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0b01001110));
  s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0b10110001));
  return _mm_cvtsi128_si32(s);
}

}  // namespace sse41
#else
inline namespace plain {

inline constexpr const char* kInstructionSet = "none";

/// 32 lanes of 8 bits.
struct U8 {
  std::uint8_t v[32];
};
/// 16 lanes of 16 bits.
struct I16 {
  std::int16_t v[16];
};

template <class F>
U8 each8(F f) {
  U8 r;
  for (int i = 0; i < 32; ++i) r.v[i] = static_cast<std::uint8_t>(f(i));
  return r;
}
template <class F>
I16 each16(F f) {
  I16 r;
  for (int i = 0; i < 16; ++i) r.v[i] = static_cast<std::int16_t>(f(i));
  return r;
}

inline U8 load(const std::uint8_t* p) {
  U8 r;
  std::memcpy(r.v, p, 32);
  return r;
}
inline U8 load_halves(const std::uint8_t* low, const std::uint8_t* high) {
  U8 r;
  std::memcpy(r.v, low, 16);
  std::memcpy(r.v + 16, high, 16);
  return r;
}
inline void store(std::uint8_t* p, U8 a) { std::memcpy(p, a.v, 32); }
inline U8 splat8(int x) {
  return each8([&](int) { return x; });
}
inline U8 min(U8 a, U8 b) {
  return each8([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
inline U8 max(U8 a, U8 b) {
  return each8([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
inline U8 average(U8 a, U8 b) {
  return each8([&](int i) { return (a.v[i] + b.v[i] + 1) >> 1; });
}
inline U8 subtract(U8 a, U8 b) {
  return each8([&](int i) { return a.v[i] > b.v[i] ? a.v[i] - b.v[i] : 0; });
}
inline U8 add(U8 a, U8 b) {
  return each8([&](int i) { return a.v[i] + b.v[i] > 255 ? 255 : a.v[i] + b.v[i]; });
}
inline U8 bit_and(U8 a, U8 b) {
  return each8([&](int i) { return a.v[i] & b.v[i]; });
}
inline U8 bit_or(U8 a, U8 b) {
  return each8([&](int i) { return a.v[i] | b.v[i]; });
}
inline bool any(U8 a) {
  unsigned sum = 0;
  for (const std::uint8_t x : a.v) sum |= x;
  return sum != 0;
}
inline U8 at_least(U8 a, U8 b) {
  return each8([&](int i) { return a.v[i] >= b.v[i] ? 255 : 0; });
}
inline std::uint32_t top_bits(U8 a) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 32; ++i) bits |= static_cast<std::uint32_t>(a.v[i] >> 7) << i;
  return bits;
}
inline U8 shuffle_halves(U8 a, U8 index) {
  return each8([&](int i) { return a.v[(i & 16) + (index.v[i] & 15)]; });
}
inline I16 dot_pairs(U8 a, U8 weight) {
  const auto signed_weight = [&](int i) { return static_cast<std::int8_t>(weight.v[i]); };
  return each16([&](int i) {
    return a.v[2 * i] * signed_weight(2 * i) + a.v[2 * i + 1] * signed_weight(2 * i + 1);
  });
}

inline I16 load(const std::int16_t* p) {
  I16 r;
  std::memcpy(r.v, p, 32);
  return r;
}
inline void store(std::int16_t* p, I16 a) { std::memcpy(p, a.v, 32); }
inline I16 splat16(int x) {
  return each16([&](int) { return x; });
}
inline I16 add(I16 a, I16 b) {
  return each16([&](int i) { return a.v[i] + b.v[i]; });
}
inline I16 subtract(I16 a, I16 b) {
  return each16([&](int i) { return a.v[i] - b.v[i]; });
}
inline I16 multiply(I16 a, I16 b) {
  return each16([&](int i) { return a.v[i] * b.v[i]; });
}
inline I16 multiply_q15(I16 a, I16 b) {
  return each16([&](int i) { return (a.v[i] * b.v[i] + 0x4000) >> 15; });
}
template <int bits>
I16 shift_right(I16 a) {
  return each16([&](int i) { return a.v[i] >> bits; });
}
inline I16 low_half(U8 a) {
  return each16([&](int i) { return a.v[i]; });
}
inline I16 high_half(U8 a) {
  return each16([&](int i) { return a.v[i + 16]; });
}
inline U8 narrow(I16 low, I16 high) {
  return each8([&](int i) {
    const int x = i < 16 ? low.v[i] : high.v[i - 16];
    return x < 0 ? 0 : x > 255 ? 255 : x;
  });
}
inline std::int32_t dot(I16 a, I16 b) {
  std::int32_t sum = 0;
  for (int i = 0; i < 16; ++i) sum += a.v[i] * b.v[i];
  return sum;
}

}  // namespace plain
#endif

}  // namespace ydd::simd
