/* The 19-state problem of Zhao, Li & Li 2012 (plant (44), observer (34), n = 2, p = 3) written out by hand: classical
   Runge-Kutta, inputs held over `hold` steps. Compiled by the benchmarks with gcc -O3 -march=native. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#define N 19 /* x1 x2 | Upsilon 2x3 | Gamma upper triangle | xh1 xh2 | th1 th2 th3 */

static inline void rates(const double *restrict s, const double *restrict w, double rho, double lambda, double *restrict d)
{
    const double x1 = s[0], x2 = s[1], *U = s + 2, *G = s + 8, h1 = s[14], h2 = s[15], *q = s + 16;
    const double u = w[0], p1 = w[1], p2 = w[2], p3 = w[3], a4 = 0.1;
    const double v = x2 / x1;
    d[0] = x2 - u * x1 + w[4] * p1 + w[5] * p2;
    d[1] = x1 * v * (2 * v - 1 - u) + a4 * u * (1 - v) * (1 - v);
    const double y = x1 + w[6] * p3 + w[7];
    const double Phi[3] = {p1, p2, 0}, Psi[3] = {0, 0, p3};
    double O[3], b[3];
    for (int j = 0; j < 3; j++) {
        d[2 + j] = rho * (U[3 + j] - U[j] - Psi[j]) + Phi[j];
        d[5 + j] = -0.5 * rho * (U[j] + Psi[j]);
        O[j] = U[j] + Psi[j];
    }
    b[0] = G[0] * O[0] + G[1] * O[1] + G[2] * O[2];
    b[1] = G[1] * O[0] + G[3] * O[1] + G[4] * O[2];
    b[2] = G[2] * O[0] + G[4] * O[1] + G[5] * O[2];
    d[8] = lambda * G[0] - b[0] * b[0];
    d[9] = lambda * G[1] - b[0] * b[1];
    d[10] = lambda * G[2] - b[0] * b[2];
    d[11] = lambda * G[3] - b[1] * b[1];
    d[12] = lambda * G[4] - b[1] * b[2];
    d[13] = lambda * G[5] - b[2] * b[2];
    const double r = y - h1 - p3 * q[2];
    const double m1 = U[0] * b[0] + U[1] * b[1] + U[2] * b[2], m2 = U[3] * b[0] + U[4] * b[1] + U[5] * b[2];
    const double c1 = h1 > 1e-3 ? h1 : 1e-3;
    double z = h2 / c1;
    z = z < 0 ? 0 : (z > 1 ? 1 : z);
    d[14] = h2 - u * h1 + p1 * q[0] + p2 * q[1] + (rho + m1) * r;
    d[15] = c1 * z * (2 * z - 1 - u) + a4 * u * (1 - z) * (1 - z) + rho * (0.5 * rho + m2) * r;
    d[16] = b[0] * r;
    d[17] = b[1] * r;
    d[18] = b[2] * r;
}

/* inputs: rows of u phi1 phi2 phi3 theta1 theta2 theta3 noise, one for each `hold` steps; out: a row each `every` steps. */
void simulate(const double *restrict inputs, long steps, long hold, double h, double rho, double lambda, long every,
              double *restrict state, double *restrict out)
{
    double s[N], k1[N], k2[N], k3[N], k4[N], z[N], w[8];
    memcpy(s, state, sizeof s);
    long left = every;
    for (long k = 0; k < steps; k += hold, inputs += 8) {
        memcpy(w, inputs, sizeof w);
        for (long j = 0; j < hold; j++) {
            rates(s, w, rho, lambda, k1);
            for (int i = 0; i < N; i++) z[i] = s[i] + 0.5 * h * k1[i];
            rates(z, w, rho, lambda, k2);
            for (int i = 0; i < N; i++) z[i] = s[i] + 0.5 * h * k2[i];
            rates(z, w, rho, lambda, k3);
            for (int i = 0; i < N; i++) z[i] = s[i] + h * k3[i];
            rates(z, w, rho, lambda, k4);
            for (int i = 0; i < N; i++) s[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
            if (--left == 0) {
                left = every;
                memcpy(out, s, sizeof s);
                out += N;
            }
        }
    }
    memcpy(state, s, sizeof s);
}

static uint64_t rotl(uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }

/* Standard normal numbers: xoshiro256+ and Marsaglia's polar method. */
static void normals(uint64_t seed, double *out, long count)
{
    uint64_t a[4];
    for (int i = 0; i < 4; i++) {
        uint64_t x = (seed += 0x9e3779b97f4a7c15ULL);
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
        a[i] = x ^ (x >> 31);
    }
    for (long i = 0; i < count; i += 2) {
        double p, q, r;
        do {
            double both[2];
            for (int j = 0; j < 2; j++) {
                const uint64_t value = a[0] + a[3], t = a[1] << 17;
                a[2] ^= a[0]; a[3] ^= a[1]; a[1] ^= a[2]; a[0] ^= a[3]; a[2] ^= t; a[3] = rotl(a[3], 45);
                both[j] = (value >> 11) * 0x1.0p-52 - 1.0;
            }
            p = both[0]; q = both[1]; r = p * p + q * q;
        } while (r >= 1 || r == 0);
        const double f = sqrt(-2 * log(r) / r);
        out[i] = p * f;
        if (i + 1 < count) out[i + 1] = q * f;
    }
}

/* One run of a batch: noise of its own seed, then the same simulation. `scratch` takes one number a row. */
void simulate_seed(double *inputs, long rows, long hold, double h, double rho, double lambda, long every,
                   const double *state, double *out, uint64_t seed, double std, double *scratch)
{
    double s[N];
    memcpy(s, state, sizeof s);
    normals(seed, scratch, rows);
    for (long i = 0; i < rows; i++) inputs[8 * i + 7] = std * scratch[i];
    simulate(inputs, rows * hold, hold, h, rho, lambda, every, s, out);
}
