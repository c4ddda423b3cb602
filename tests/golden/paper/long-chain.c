// The chain of 300 cells of Figs 4 to 7 by classical Runge-Kutta with fixed steps, sharing nothing with the program.
//
//   cc -O2 -o long-chain long-chain.c -lm
//   ./long-chain LINEAR_0_OR_1 SPEED_M_PER_S DURATION_S STEP_S EVERY
//
// Prints a line each EVERY steps: time, dynamic force between particles 1 and 2, and inside 5, 11, 12, 21, 51, 101, 151.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LAST = 600 };
static const double A = 119414718.64581832, PRELOAD = 2.38;
static double overlap, slope, mass[LAST + 1];
static int linear;

static double force(double closer) {
    double d = overlap + closer;
    if (linear) return slope * closer;
    return (d > 0 ? A * d * sqrt(d) : 0) - PRELOAD;
}

static void accelerate(const double *u, double *a) {
    static double f[LAST + 2];
    for (int j = 2; j <= LAST; j++) f[j] = force(u[j - 1] - u[j]);
    for (int i = 1; i <= LAST; i++) a[i] = (f[i] - f[i + 1]) / mass[i];
}

int main(int count, char **words) {
    if (count != 6) return 2;
    static double u[LAST + 2], v[LAST + 2], a1[LAST + 2], a2[LAST + 2], a3[LAST + 2], a4[LAST + 2];
    static double v2[LAST + 2], v3[LAST + 2], v4[LAST + 2], at[LAST + 2];
    const int felt[] = {5, 11, 12, 21, 51, 101, 151};
    double h = atof(words[4]);
    linear = atoi(words[1]);
    v[1] = atof(words[2]);
    overlap = pow(PRELOAD / A, 2.0 / 3);
    slope = 1.5 * A * sqrt(overlap);
    for (int i = 1; i <= LAST; i++) mass[i] = i % 2 ? 0.1226e-3 : 0.485e-3;
    for (long n = 0; n < lround(atof(words[3]) / h); n++) {
        if (n % atol(words[5]) == 0) {
            printf("%.9g %.9g", n * h, force(u[1] - u[2]));
            for (int k = 0; k < 7; k++) {
                int p = felt[k];
                printf(" %.9g", (force(u[p - 1] - u[p]) + force(u[p] - u[p + 1])) / 2);
            }
            printf("\n");
        }
        accelerate(u, a1);
        for (int i = 1; i <= LAST; i++) at[i] = u[i] + h / 2 * v[i], v2[i] = v[i] + h / 2 * a1[i];
        accelerate(at, a2);
        for (int i = 1; i <= LAST; i++) at[i] = u[i] + h / 2 * v2[i], v3[i] = v[i] + h / 2 * a2[i];
        accelerate(at, a3);
        for (int i = 1; i <= LAST; i++) at[i] = u[i] + h * v3[i], v4[i] = v[i] + h * a3[i];
        accelerate(at, a4);
        for (int i = 1; i <= LAST; i++) {
            u[i] += h / 6 * (v[i] + 2 * v2[i] + 2 * v3[i] + v4[i]);
            v[i] += h / 6 * (a1[i] + 2 * a2[i] + 2 * a3[i] + a4[i]);
        }
    }
}
