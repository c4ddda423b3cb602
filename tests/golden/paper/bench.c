// The bench of 38 particles by classical Runge-Kutta with fixed steps, sharing nothing with the program.
//
//   cc -O2 -o bench bench.c -lm
//   ./bench MASS_KG SPEED_M_PER_S MAGNET_N DASHPOT_N_S_PER_M DURATION_S STEP_S EVERY
//
// Prints a line each EVERY steps: time, dynamic force inside particles 2, 7, 14, 27, 38 and at the wall. A dashpot acts
// in every contact, striker and wall included, while bodies overlap.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { BODIES = 39 };
static double mass[BODIES], stiffness[BODIES + 1], overlap[BODIES + 1], rest[BODIES + 1], dashpot;

static double force(int j, const double *u, const double *v) {
    double d = overlap[j] + (j == BODIES ? u[j - 1] : u[j - 1] - u[j]);
    double closing = j == BODIES ? v[j - 1] : v[j - 1] - v[j];
    return d > 0 ? stiffness[j] * d * sqrt(d) + dashpot * closing : 0;
}

static void accelerate(const double *u, const double *v, double *a) {
    double f[BODIES + 1];
    for (int j = 1; j <= BODIES; j++) f[j] = force(j, u, v) - rest[j];
    a[0] = 9.81 - f[1] / mass[0];
    for (int i = 1; i < BODIES; i++) a[i] = (f[i] - f[i + 1]) / mass[i];
}

static void step(double *u, double *v, double h) {
    double a1[BODIES], a2[BODIES], a3[BODIES], a4[BODIES], v2[BODIES], v3[BODIES], v4[BODIES], at[BODIES];
    accelerate(u, v, a1);
    for (int i = 0; i < BODIES; i++) at[i] = u[i] + h / 2 * v[i], v2[i] = v[i] + h / 2 * a1[i];
    accelerate(at, v2, a2);
    for (int i = 0; i < BODIES; i++) at[i] = u[i] + h / 2 * v2[i], v3[i] = v[i] + h / 2 * a2[i];
    accelerate(at, v3, a3);
    for (int i = 0; i < BODIES; i++) at[i] = u[i] + h * v3[i], v4[i] = v[i] + h * a3[i];
    accelerate(at, v4, a4);
    for (int i = 0; i < BODIES; i++) {
        u[i] += h / 6 * (v[i] + 2 * v2[i] + 2 * v3[i] + v4[i]);
        v[i] += h / 6 * (a1[i] + 2 * a2[i] + 2 * a3[i] + a4[i]);
    }
}

int main(int count, char **words) {
    if (count != 8) return 2;
    double u[BODIES] = {0}, v[BODIES] = {0}, bears = atof(words[3]), h = atof(words[6]);
    const int felt[] = {2, 7, 14, 27, 38};
    dashpot = atof(words[4]);
    mass[0] = atof(words[1]);
    v[0] = atof(words[2]);
    mass[1] = 0.45e-3;
    for (int i = 2; i < BODIES; i++) mass[i] = i % 2 ? 0.485e-3 : 0.1226e-3;
    stiffness[1] = 9169263323.24789;
    stiffness[2] = 84438957.3279418;
    for (int j = 3; j <= BODIES; j++) stiffness[j] = 119414718.64581832;
    for (int j = 2; j <= BODIES; j++) {
        bears += 9.81 * mass[j - 1];
        rest[j] = bears;
        overlap[j] = pow(bears / stiffness[j], 2.0 / 3);
    }
    for (long n = 0; n <= lround(atof(words[5]) / h); n++) {
        if (n % atol(words[7]) == 0) {
            printf("%.9g", n * h);
            for (int k = 0; k < 5; k++) {
                int p = felt[k];
                printf(" %.9g", (force(p, u, v) - rest[p] + force(p + 1, u, v) - rest[p + 1]) / 2);
            }
            printf(" %.9g\n", force(BODIES, u, v) - rest[BODIES]);
        }
        step(u, v, h);
    }
}
