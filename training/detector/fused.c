// SPDX-License-Identifier: Apache-2.0
// Batch norm and SiLU of a training step in few passes over memory.
// Activations are bfloat16, rows x channels (channels last), channels a multiple of 16; sums end in double.
// y = z p(z), p(z) = 1 / (1 + e^-z), z = gain x^ + shift, x^ = (x - mean) / deviation:
// Ioffe and Szegedy 2015; Elfwing et al. 2018.
#include <stdint.h>

enum { LANES = 16, BLOCK = 256 };  // channels at a time; rows summed in float

typedef float Floats __attribute__((vector_size(64), aligned(4), may_alias));
typedef uint32_t Words __attribute__((vector_size(64)));
typedef int32_t Ints __attribute__((vector_size(64)));
typedef uint16_t Halves __attribute__((vector_size(32), aligned(2), may_alias));

static inline Floats load(const uint16_t* p) {
  return (Floats)(__builtin_convertvector(*(const Halves*)p, Words) << 16);
}

static inline void store(uint16_t* p, Floats f) {
  const Words u = (Words)f;
  *(Halves*)p = __builtin_convertvector((u + 0x7fff + ((u >> 16) & 1)) >> 16, Halves);
}

static inline Floats at(const float* p) { return *(const Floats*)p; }

static inline Floats lesser(Floats a, Floats b) {
  const Ints m = a < b;
  return (Floats)(((Ints)a & m) | ((Ints)b & ~m));
}

// Logistic function to 1e-5: 2^t = 2^whole times the Taylor polynomial of the rest in [-0.5, 0.5].
static inline Floats logistic(Floats z) {
  Floats t = lesser(z * -1.44269504f, (Floats){} + 120.0f);
  t = -lesser(-t, (Floats){} + 120.0f);
  const Ints whole = __builtin_convertvector(t + 128.5f, Ints) - 128;  // t + 128.5 > 0: rounds down
  t -= __builtin_convertvector(whole, Floats);
  const Floats e = 1.0f + t * (0.69314718f + t * (0.24022651f + t * (0.05550411f + t * (0.00961813f + t * 0.00133336f))));
  return 1.0f / (1.0f + e * (Floats)((whole + 127) << 23));
}

static inline long least(long a, long b) { return a < b ? a : b; }

static void add_up(double* total, Floats part) {
  for (int k = 0; k < LANES; ++k) total[k] += part[k];
}

// Mean and biased variance of every channel.
void moments(const uint16_t* x, long rows, int channels, float* mean, float* variance) {
  for (int c = 0; c < channels; c += LANES) {
    double sum[LANES] = {0}, square[LANES] = {0};
    for (long r0 = 0; r0 < rows; r0 += BLOCK) {
      Floats s = {}, q = {};
      for (long r = r0; r < least(rows, r0 + BLOCK); ++r) {
        const Floats v = load(x + r * channels + c);
        s += v;
        q += v * v;
      }
      add_up(sum, s), add_up(square, q);
    }
    for (int k = 0; k < LANES; ++k) {
      const double m = sum[k] / rows, v = square[k] / rows - m * m;
      mean[c + k] = (float)m;
      variance[c + k] = (float)(v > 0 ? v : 0);
    }
  }
}

// y = z p(z) with z = a x + b.
void activate(const uint16_t* x, long rows, int channels, const float* a, const float* b, uint16_t* y) {
  for (long r = 0; r < rows; ++r)
    for (int c = 0; c < channels; c += LANES) {
      const Floats z = at(a + c) * load(x + r * channels + c) + at(b + c);
      store(y + r * channels + c, z * logistic(z));
    }
}

// dL/dz into dx, its sum and its product with x^ into dshift and dgain, for 16 channels from c on.
static void back_through_silu(const uint16_t* x, const uint16_t* dy, long rows, int channels, int c, const float* gain,
                              const float* shift, const float* mean, const float* inverse, float* dgain, float* dshift,
                              uint16_t* dx) {
  double sum[LANES] = {0}, product[LANES] = {0};
  const Floats g = at(gain + c), h = at(shift + c), m = at(mean + c), i = at(inverse + c);
  for (long r0 = 0; r0 < rows; r0 += BLOCK) {
    Floats s = {}, q = {};
    for (long r = r0; r < least(rows, r0 + BLOCK); ++r) {
      const Floats xh = (load(x + r * channels + c) - m) * i, z = g * xh + h, p = logistic(z);
      const Floats dz = load(dy + r * channels + c) * p * (1.0f + z * (1.0f - p));
      s += dz;
      q += dz * xh;
      store(dx + r * channels + c, dz);
    }
    add_up(sum, s), add_up(product, q);
  }
  for (int k = 0; k < LANES; ++k) dshift[c + k] = (float)sum[k], dgain[c + k] = (float)product[k];
}

// From dL/dy: dL/dgain, dL/dshift, dL/dx.
void back(const uint16_t* x, const uint16_t* dy, long rows, int channels, const float* gain, const float* shift,
          const float* mean, const float* inverse, float* dgain, float* dshift, uint16_t* dx) {
  for (int c = 0; c < channels; c += LANES)
    back_through_silu(x, dy, rows, channels, c, gain, shift, mean, inverse, dgain, dshift, dx);
  const float share = 1.0f / (float)rows;
  for (long r = 0; r < rows; ++r)
    for (int c = 0; c < channels; c += LANES) {
      const long n = r * channels + c;
      const Floats i = at(inverse + c), xh = (load(x + n) - at(mean + c)) * i;
      store(dx + n, at(gain + c) * i * (load(dx + n) - share * (at(dshift + c) + xh * at(dgain + c))));
    }
}
