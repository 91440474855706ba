// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/resample_detail.h"

#if defined(__x86_64__)

#include <immintrin.h>

#include <bit>

// Compiled for AVX2 function by function, so that no inline function of a library header is built
// for a machine that may not be there.
#define RSSTAB_AVX2 __attribute__((target("avx2")))
#define RSSTAB_AVX2_INLINE __attribute__((target("avx2"), always_inline)) inline

namespace rsstab::stabilizer::detail {
namespace {

// Eight output samples are computed together, four in each 128-bit lane. A lane reads 16 bytes of a
// source row from its first sample's leftmost tap on, and a byte shuffle hands every sample the
// pair of taps that it needs; the next pair of taps is the same shuffle of the bytes one pair
// further. The lane's rows start at its topmost sample. Samples on a lower row see the same rows
// with their weights moved down, for which two more rows than taps are filtered.
constexpr int kSamples = 8;
constexpr int kLaneSamples = 4;
constexpr int kLaneBytes = 16;
constexpr int kMaxRowDrop = FilterBank::kMargin;

template <typename Sample, int kTaps>
struct Avx2Kernel {
  static constexpr int kBytes = static_cast<int>(sizeof(Sample));
  static constexpr int kBefore = kTaps / 2 - 1;  // taps left of or above the position's floor
  static constexpr int kPairs = kTaps / 2;

  // What is the same for all samples of a row.
  struct Constants {
    int pixel_bytes;
    __m128i pixel_shift;     // log2(pixel_bytes)
    __m256i channel_offset;  // bytes, per sample
    __m256i last_offset;     // greatest byte offset that a lane's 16 bytes can serve
    __m256i tap_pair_bytes;  // shuffle control of a pair of taps, relative to its first byte
    __m256i last_x;          // greatest position of a lane's first tap with all reads inside
    __m256i last_y;          //   the picture, for samples on one row
    __m256i bias;
    __m256i along_row_round;
    __m128i along_row_shift;
    __m256i down_round;
    __m128i down_shift;
    __m256i level_bias;
    __m128i maximum;
  };

  // The 16 bytes of the last pair of taps end with the row at the latest.
  static int LastX(const ResampleRow& row) {
    const int pixel_bytes = row.channels * kBytes;
    return row.source_width - (kLaneBytes + pixel_bytes - 1) / pixel_bytes - (kTaps - 2);
  }
  static int LastY(const ResampleRow& row) { return row.source_height - kTaps; }

  RSSTAB_AVX2 static Constants MakeConstants(const ResampleRow& row) {
    const FixedPoint format(row.bit_depth);
    const int pixel_bytes = row.channels * kBytes;
    const int c2 = row.channels > 1 ? kBytes : 0;
    const int c4 = row.channels > 2 ? 2 * kBytes : 0;
    // Bytes of two 16-bit factors: this tap's and the next one's. 0x80 makes a zero byte.
    const unsigned next = static_cast<unsigned>(pixel_bytes);
    const unsigned control =
        kBytes == 1 ? 0x80008000U | (next << 16) : 0x01000100U | (next << 16) | (next << 24);
    return {
        pixel_bytes,
        _mm_cvtsi32_si128(std::countr_zero(static_cast<unsigned>(pixel_bytes))),
        _mm256_setr_epi32(0, c2, c4, c4 + c2, 0, c2, c4, c4 + c2),
        _mm256_set1_epi32(kLaneBytes - pixel_bytes - kBytes),
        _mm256_set1_epi32(static_cast<int>(control)),
        _mm256_set1_epi32(LastX(row)),
        _mm256_set1_epi32(LastY(row)),
        _mm256_set1_epi16(static_cast<short>(format.bias)),
        _mm256_set1_epi32(1 << (format.along_row_shift - 1)),
        _mm_cvtsi32_si128(format.along_row_shift),
        _mm256_set1_epi32(1 << (format.down_shift - 1)),
        _mm_cvtsi32_si128(format.down_shift),
        _mm256_set1_epi32(format.bias),
        _mm_set1_epi16(static_cast<short>(format.maximum)),
    };
  }

  RSSTAB_AVX2_INLINE static __m256i LoadLanes(const void* low, const void* high) {
    return _mm256_inserti128_si256(
        _mm256_castsi128_si256(_mm_loadu_si128(static_cast<const __m128i*>(low))),
        _mm_loadu_si128(static_cast<const __m128i*>(high)), 1);
  }

  // True where 0 <= a <= b.
  RSSTAB_AVX2_INLINE static __m256i WithinZeroAnd(__m256i a, __m256i b) {
    return _mm256_cmpeq_epi32(_mm256_min_epu32(a, b), a);
  }

  // Turns the weights of eight samples, from `entries` on, into `kCount` vectors of weight pairs.
  template <int kCount>
  RSSTAB_AVX2_INLINE static void LoadWeightPairs(const std::int16_t* const (&entries)[kSamples],
                                                 __m256i (&pairs)[kCount]) {
    const __m256i a = LoadLanes(entries[0], entries[4]);
    const __m256i b = LoadLanes(entries[1], entries[5]);
    const __m256i c = LoadLanes(entries[2], entries[6]);
    const __m256i d = LoadLanes(entries[3], entries[7]);
    const __m256i ab01 = _mm256_unpacklo_epi32(a, b);
    const __m256i cd01 = _mm256_unpacklo_epi32(c, d);
    const __m256i ab23 = _mm256_unpackhi_epi32(a, b);
    const __m256i cd23 = _mm256_unpackhi_epi32(c, d);
    pairs[0] = _mm256_unpacklo_epi64(ab01, cd01);
    if constexpr (kCount > 1) {
      pairs[1] = _mm256_unpackhi_epi64(ab01, cd01);
    }
    if constexpr (kCount > 2) {
      pairs[2] = _mm256_unpacklo_epi64(ab23, cd23);
    }
    if constexpr (kCount > 3) {
      pairs[3] = _mm256_unpackhi_epi64(ab23, cd23);
    }
  }

  // Filters one source row for all eight samples.
  RSSTAB_AVX2_INLINE static __m256i AlongRow(const std::uint8_t* low, const std::uint8_t* high,
                                             __m256i shuffle, const __m256i (&weights)[kPairs],
                                             const Constants& constants) {
    __m256i sum = constants.along_row_round;
    for (int j = 0; j < kPairs; ++j) {
      const std::ptrdiff_t offset = 2 * j * constants.pixel_bytes;
      __m256i taps = _mm256_shuffle_epi8(LoadLanes(low + offset, high + offset), shuffle);
      if constexpr (kBytes == 2) {
        taps = _mm256_xor_si256(taps, constants.bias);  // subtracts 2^15 or nothing
      }
      sum = _mm256_add_epi32(sum, _mm256_madd_epi16(taps, weights[j]));
    }
    return _mm256_sra_epi32(sum, constants.along_row_shift);
  }

  // `low`, `high`: the byte under the first tap of each lane's first sample. `entries_y`: weights
  // of 2 kRowPairs rows.
  template <int kRowPairs>
  RSSTAB_AVX2_INLINE static __m256i FilterEight(const std::uint8_t* low, const std::uint8_t* high,
                                                std::ptrdiff_t stride, __m256i shuffle,
                                                const std::int16_t* const (&entries_x)[kSamples],
                                                const std::int16_t* const (&entries_y)[kSamples],
                                                const Constants& constants) {
    // Two packed rows per lane, eight 16-bit sums -> four pairs (upper row, lower row).
    const __m256i interleave =
        _mm256_setr_epi8(0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15,  //
                         0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15);
    __m256i weights_x[kPairs];
    __m256i weights_y[kRowPairs];
    LoadWeightPairs(entries_x, weights_x);
    LoadWeightPairs(entries_y, weights_y);
    __m256i total = constants.down_round;
    for (int j = 0; j < kRowPairs; ++j) {
      const std::ptrdiff_t upper = 2 * j * stride;
      const std::ptrdiff_t lower = upper + stride;
      const __m256i rows =
          _mm256_packs_epi32(AlongRow(low + upper, high + upper, shuffle, weights_x, constants),
                             AlongRow(low + lower, high + lower, shuffle, weights_x, constants));
      total = _mm256_add_epi32(
          total, _mm256_madd_epi16(_mm256_shuffle_epi8(rows, interleave), weights_y[j]));
    }
    return _mm256_add_epi32(_mm256_sra_epi32(total, constants.down_shift), constants.level_bias);
  }

  RSSTAB_AVX2_INLINE static void Store(std::uint8_t* output, __m256i values,
                                       const Constants& constants) {
    const __m128i low = _mm256_castsi256_si128(values);
    const __m128i high = _mm256_extracti128_si256(values, 1);
    if constexpr (kBytes == 1) {
      const __m128i words = _mm_packs_epi32(low, high);
      _mm_storel_epi64(reinterpret_cast<__m128i*>(output), _mm_packus_epi16(words, words));
    } else {
      const __m128i words = _mm_min_epu16(_mm_packus_epi32(low, high), constants.maximum);
      _mm_storeu_si128(reinterpret_cast<__m128i*>(output), words);
    }
  }

  RSSTAB_AVX2 static void Run(const ResampleRow& row, const FilterBank& filter) {
    const int count = static_cast<int>(row.source_x.size());
    int done = 0;
    // Smaller planes are all border.
    if (LastX(row) >= 0 && LastY(row) >= kMaxRowDrop) {
      const Constants constants = MakeConstants(row);
      for (; done + kSamples <= count; done += kSamples) {
        if (!RunEight(row, filter, constants, done)) {
          ResamplePortable(row, filter, done, done + kSamples);
        }
      }
    }
    ResamplePortable(row, filter, done, count);
  }

  // Computes samples [first, first + 8) unless they touch the border or lie too far apart.
  RSSTAB_AVX2_INLINE static bool RunEight(const ResampleRow& row, const FilterBank& filter,
                                          const Constants& constants, int first) {
    const std::int32_t* source_x = row.source_x.data() + first;
    const std::int32_t* source_y = row.source_y.data() + first;
    const __m256i before = _mm256_set1_epi32(kBefore);
    const __m256i x = _mm256_sub_epi32(
        _mm256_srai_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(source_x)),
                          kPhaseBits),
        before);
    const __m256i y = _mm256_sub_epi32(
        _mm256_srai_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(source_y)),
                          kPhaseBits),
        before);
    const __m256i lane_x = _mm256_shuffle_epi32(x, 0x00);
    const __m256i y_pairs = _mm256_min_epi32(y, _mm256_shuffle_epi32(y, 0xB1));
    const __m256i lane_y = _mm256_min_epi32(y_pairs, _mm256_shuffle_epi32(y_pairs, 0x4E));
    const __m256i drop = _mm256_sub_epi32(y, lane_y);
    const __m256i offset =
        _mm256_add_epi32(_mm256_sll_epi32(_mm256_sub_epi32(x, lane_x), constants.pixel_shift),
                         constants.channel_offset);

    const bool level = _mm256_testz_si256(drop, drop) != 0;
    __m256i fits = _mm256_and_si256(WithinZeroAnd(lane_x, constants.last_x),
                                    WithinZeroAnd(offset, constants.last_offset));
    __m256i last_y = constants.last_y;
    if (!level) {
      const __m256i max_drop = _mm256_set1_epi32(kMaxRowDrop);
      fits = _mm256_and_si256(fits, WithinZeroAnd(drop, max_drop));
      last_y = _mm256_sub_epi32(last_y, max_drop);
    }
    fits = _mm256_and_si256(fits, WithinZeroAnd(lane_y, last_y));
    if (_mm256_movemask_epi8(fits) != -1) {
      return false;
    }

    // A pair of taps as bytes: the sample's offset in all four, plus where its parts lie.
    const __m256i spread = _mm256_setr_epi8(0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12,  //
                                            0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12);
    const __m256i shuffle =
        _mm256_add_epi8(_mm256_shuffle_epi8(offset, spread), constants.tap_pair_bytes);

    const std::uint8_t* low =
        row.source + _mm256_extract_epi32(lane_y, 0) * row.source_stride +
        static_cast<std::ptrdiff_t>(_mm256_extract_epi32(lane_x, 0)) * constants.pixel_bytes;
    const std::uint8_t* high =
        row.source + _mm256_extract_epi32(lane_y, kLaneSamples) * row.source_stride +
        static_cast<std::ptrdiff_t>(_mm256_extract_epi32(lane_x, kLaneSamples)) *
            constants.pixel_bytes;

    const std::int16_t* entries_x[kSamples];
    const std::int16_t* entries_y[kSamples];
    for (int i = 0; i < kSamples; ++i) {
      entries_x[i] = filter.Weights(source_x[i] & (kPhases - 1));
      entries_y[i] = filter.Weights(source_y[i] & (kPhases - 1));
    }
    __m256i values;
    if (level) {
      values = FilterEight<kPairs>(low, high, row.source_stride, shuffle, entries_x, entries_y,
                                   constants);
    } else {
      alignas(32) std::int32_t drops[kSamples];
      _mm256_store_si256(reinterpret_cast<__m256i*>(drops), drop);
      for (int i = 0; i < kSamples; ++i) {
        entries_y[i] -= drops[i];
      }
      values = FilterEight<kPairs + kMaxRowDrop / 2>(low, high, row.source_stride, shuffle,
                                                     entries_x, entries_y, constants);
    }
    Store(row.output + static_cast<std::ptrdiff_t>(first) * kBytes, values, constants);
    return true;
  }
};

}  // namespace

void ResampleAvx2(const ResampleRow& row, const FilterBank& filter) {
  const bool bytes = row.bit_depth == 8;
  switch (filter.taps()) {
    case 2:
      return bytes ? Avx2Kernel<std::uint8_t, 2>::Run(row, filter)
                   : Avx2Kernel<std::uint16_t, 2>::Run(row, filter);
    case 4:
      return bytes ? Avx2Kernel<std::uint8_t, 4>::Run(row, filter)
                   : Avx2Kernel<std::uint16_t, 4>::Run(row, filter);
    default:
      return bytes ? Avx2Kernel<std::uint8_t, 6>::Run(row, filter)
                   : Avx2Kernel<std::uint16_t, 6>::Run(row, filter);
  }
}

}  // namespace rsstab::stabilizer::detail

#endif
