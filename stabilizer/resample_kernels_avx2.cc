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
constexpr int kMaxRowDrop = 2;
constexpr int kRowsAhead = 6;  // prefetched below the last tap

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
    // FixedPoint:
    __m256i bias;  // 16 bit
    __m256i along_row_round;
    __m128i along_row_shift;
    __m256i down_round;
    __m128i down_shift;
    __m256i level_bias;  // 32 bit
    __m128i maximum;     // 16 bit
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
        .pixel_bytes = pixel_bytes,
        .pixel_shift = _mm_cvtsi32_si128(std::countr_zero(static_cast<unsigned>(pixel_bytes))),
        .channel_offset = _mm256_setr_epi32(0, c2, c4, c4 + c2, 0, c2, c4, c4 + c2),
        .last_offset = _mm256_set1_epi32(kLaneBytes - pixel_bytes - kBytes),
        .tap_pair_bytes = _mm256_set1_epi32(static_cast<int>(control)),
        .last_x = _mm256_set1_epi32(LastX(row)),
        .last_y = _mm256_set1_epi32(LastY(row)),
        .bias = _mm256_set1_epi16(static_cast<short>(format.bias)),
        .along_row_round = _mm256_set1_epi32(1 << (format.along_row_shift - 1)),
        .along_row_shift = _mm_cvtsi32_si128(format.along_row_shift),
        .down_round = _mm256_set1_epi32(1 << (format.down_shift - 1)),
        .down_shift = _mm_cvtsi32_si128(format.down_shift),
        .level_bias = _mm256_set1_epi32(format.bias),
        .maximum = _mm_set1_epi16(static_cast<short>(format.maximum)),
    };
  }

  RSSTAB_AVX2_INLINE static __m256i Load(const std::int32_t* values) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values));
  }

  RSSTAB_AVX2_INLINE static __m256i LoadLanes(const void* low, const void* high) {
    return _mm256_inserti128_si256(
        _mm256_castsi128_si256(_mm_loadu_si128(static_cast<const __m128i*>(low))),
        _mm_loadu_si128(static_cast<const __m128i*>(high)), 1);
  }

  // True where 0 <= a <= b.
  RSSTAB_AVX2_INLINE static __m256i FromZeroTo(__m256i a, __m256i b) {
    return _mm256_cmpeq_epi32(_mm256_min_epu32(a, b), a);
  }

  // The weights of eight samples' positions, a vector per pair of taps.
  struct Weights {
    __m256i x[kPairs];
    __m256i y[kPairs];
  };

  RSSTAB_AVX2_INLINE static void LoadPairs(const FilterBank& filter, const std::int32_t* positions,
                                           __m256i (&pairs)[kPairs]) {
    const auto load = [&](int low, int high) RSSTAB_AVX2 {
      return LoadLanes(filter.Weights(PhaseOf(positions[low])),
                       filter.Weights(PhaseOf(positions[high])));
    };
    const __m256i a = load(0, 4);
    const __m256i b = load(1, 5);
    const __m256i c = load(2, 6);
    const __m256i d = load(3, 7);
    const __m256i ab = _mm256_unpacklo_epi32(a, b);
    const __m256i cd = _mm256_unpacklo_epi32(c, d);
    pairs[0] = _mm256_unpacklo_epi64(ab, cd);
    pairs[1] = _mm256_unpackhi_epi64(ab, cd);
    pairs[2] = _mm256_unpacklo_epi64(_mm256_unpackhi_epi32(a, b), _mm256_unpackhi_epi32(c, d));
  }

  // The integer formulas of FilterBank, for both axes at once where there is one.
  RSSTAB_AVX2_INLINE static Weights MakeWeights(const FilterBank& filter,
                                                const std::int32_t* source_x,
                                                const std::int32_t* source_y) {
    Weights weights;
    if constexpr (kTaps == 6) {
      LoadPairs(filter, source_x, weights.x);
      LoadPairs(filter, source_y, weights.y);
    } else {
      constexpr int kPerPhaseBits = kWeightBits - kPhaseBits;
      const __m256i mask = _mm256_set1_epi32(kPhases - 1);
      // Per lane, the phases of four x and of four y.
      const __m256i t = _mm256_packs_epi32(_mm256_and_si256(Load(source_x), mask),
                                           _mm256_and_si256(Load(source_y), mask));
      const __m256i u = _mm256_sub_epi16(_mm256_set1_epi16(kPhases), t);
      const __m256i near_left = _mm256_slli_epi16(u, kPerPhaseBits);
      const __m256i near_right = _mm256_slli_epi16(t, kPerPhaseBits);
      if constexpr (kTaps == 2) {
        weights.x[0] = _mm256_unpacklo_epi16(near_left, near_right);
        weights.y[0] = _mm256_unpackhi_epi16(near_left, near_right);
      } else {
        // mulhrs rounds a product / 2^15; the factor 2^4 makes that / 2^11.
        const __m256i tu = _mm256_mullo_epi16(t, u);
        const __m256i a = _mm256_mulhrs_epi16(tu, _mm256_slli_epi16(u, 4));
        const __m256i b = _mm256_mulhrs_epi16(tu, _mm256_slli_epi16(t, 4));
        const __m256i left =
            _mm256_add_epi16(near_left, _mm256_sub_epi16(_mm256_add_epi16(a, a), b));
        const __m256i right =
            _mm256_add_epi16(near_right, _mm256_sub_epi16(_mm256_add_epi16(b, b), a));
        const __m256i zero = _mm256_setzero_si256();
        const __m256i far_left = _mm256_sub_epi16(zero, a);
        const __m256i far_right = _mm256_sub_epi16(zero, b);
        weights.x[0] = _mm256_unpacklo_epi16(far_left, left);
        weights.x[1] = _mm256_unpacklo_epi16(right, far_right);
        weights.y[0] = _mm256_unpackhi_epi16(far_left, left);
        weights.y[1] = _mm256_unpackhi_epi16(right, far_right);
      }
    }
    return weights;
  }

  // Moves every sample's weights down by its `drop` rows, 0..kMaxRowDrop.
  RSSTAB_AVX2_INLINE static void MoveDown(const __m256i (&weights)[kPairs], __m256i drop,
                                          __m256i (&moved)[kPairs + 1]) {
    // 16 bits a row; a shift by 32 leaves nothing.
    const __m256i down = _mm256_slli_epi32(drop, 4);
    const __m256i carry = _mm256_sub_epi32(_mm256_set1_epi32(32), down);
    moved[0] = _mm256_sllv_epi32(weights[0], down);
    for (int j = 1; j < kPairs; ++j) {
      moved[j] = _mm256_or_si256(_mm256_srlv_epi32(weights[j - 1], carry),
                                 _mm256_sllv_epi32(weights[j], down));
    }
    moved[kPairs] = _mm256_srlv_epi32(weights[kPairs - 1], carry);
  }

  // Filters one source row for all eight samples.
  RSSTAB_AVX2_INLINE static __m256i AlongRow(const std::uint8_t* low, const std::uint8_t* high,
                                             __m256i shuffle, const __m256i (&weights)[kPairs],
                                             const Constants& constants) {
    __m256i sum = constants.along_row_round;
    for (int j = 0; j < kPairs; ++j) {
      const std::ptrdiff_t offset = 2 * static_cast<std::ptrdiff_t>(j) * constants.pixel_bytes;
      __m256i taps = _mm256_shuffle_epi8(LoadLanes(low + offset, high + offset), shuffle);
      if constexpr (kBytes == 2) {
        taps = _mm256_xor_si256(taps, constants.bias);  // subtracts 2^15 or nothing
      }
      sum = _mm256_add_epi32(sum, _mm256_madd_epi16(taps, weights[j]));
    }
    return _mm256_sra_epi32(sum, constants.along_row_shift);
  }

  // `low`, `high`: the byte under the first tap of each lane's first sample.
  template <int kRowPairs>
  RSSTAB_AVX2_INLINE static __m256i FilterEight(const std::uint8_t* low, const std::uint8_t* high,
                                                std::ptrdiff_t stride, __m256i shuffle,
                                                const __m256i (&weights_x)[kPairs],
                                                const __m256i (&weights_y)[kRowPairs],
                                                const Constants& constants) {
    // Two packed rows per lane, eight 16-bit sums -> four pairs (upper row, lower row).
    const __m256i interleave =
        _mm256_setr_epi8(0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15,  //
                         0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15);
    __m256i total = constants.down_round;
    for (int j = 0; j < kRowPairs; ++j) {
      const std::ptrdiff_t upper = 2 * static_cast<std::ptrdiff_t>(j) * stride;
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
    const __m256i x = _mm256_sub_epi32(_mm256_srai_epi32(Load(source_x), kPhaseBits), before);
    const __m256i y = _mm256_sub_epi32(_mm256_srai_epi32(Load(source_y), kPhaseBits), before);
    const __m256i lane_x = _mm256_shuffle_epi32(x, 0x00);
    const __m256i y_pairs = _mm256_min_epi32(y, _mm256_shuffle_epi32(y, 0xB1));
    const __m256i lane_y = _mm256_min_epi32(y_pairs, _mm256_shuffle_epi32(y_pairs, 0x4E));
    const __m256i drop = _mm256_sub_epi32(y, lane_y);
    const __m256i offset =
        _mm256_add_epi32(_mm256_sll_epi32(_mm256_sub_epi32(x, lane_x), constants.pixel_shift),
                         constants.channel_offset);

    const bool level = _mm256_testz_si256(drop, drop) != 0;
    __m256i fits = _mm256_and_si256(FromZeroTo(lane_x, constants.last_x),
                                    FromZeroTo(offset, constants.last_offset));
    __m256i last_y = constants.last_y;
    if (!level) {
      const __m256i max_drop = _mm256_set1_epi32(kMaxRowDrop);
      fits = _mm256_and_si256(fits, FromZeroTo(drop, max_drop));
      last_y = _mm256_sub_epi32(last_y, max_drop);
    }
    fits = _mm256_and_si256(fits, FromZeroTo(lane_y, last_y));
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

    // The rows that later output rows will need: without it a third of the time is spent waiting
    // for them. A prefetch may point anywhere.
    _mm_prefetch(low + (kTaps + kRowsAhead) * row.source_stride, _MM_HINT_T0);

    const Weights weights = MakeWeights(filter, source_x, source_y);
    __m256i values;
    if (level) {
      values = FilterEight(low, high, row.source_stride, shuffle, weights.x, weights.y, constants);
    } else {
      __m256i weights_y[kPairs + 1];
      MoveDown(weights.y, drop, weights_y);
      values = FilterEight(low, high, row.source_stride, shuffle, weights.x, weights_y, constants);
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
