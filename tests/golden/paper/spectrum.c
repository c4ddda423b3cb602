// Spectrum of one column of what the other two print: the paper's |X|/M, five times padded, term by term.
//
//   cc -O2 -o spectrum spectrum.c -lm
//   ./spectrum COLUMN FROM_S TO_S LOW_HZ HIGH_HZ < FORCES
//
// Prints the mean frequency up to 20 kHz, weighted with squared amplitudes, the share of these between LOW and HIGH, and
// the highest line between them. Columns count from 1, the first force; TO is left out.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST = 200000 };

int main(int count, char **words) {
    if (count != 6) return 2;
    static double x[MOST], t[MOST];
    static char line[4096];
    double from = atof(words[2]), to = atof(words[3]), low = atof(words[4]), high = atof(words[5]);
    double weighted = 0, all = 0, inside = 0, highest = 0, at = 0;
    int n = 0;
    while (n < MOST && fgets(line, sizeof line, stdin)) {
        char *rest = line;
        double time = strtod(rest, &rest), value = 0;
        for (int column = 0; column < atoi(words[1]); column++) value = strtod(rest, &rest);
        if (time > from - 1e-12 && time < to - 1e-12) t[n] = time, x[n++] = value;
    }
    double width = 1 / (5 * n * (t[1] - t[0]));
    for (long k = 0; k * width < 20e3; k++) {
        double re = 0, im = 0;
        for (int i = 0; i < n; i++) {
            double angle = 2 * M_PI * k * i / (5.0 * n);
            re += x[i] * cos(angle), im -= x[i] * sin(angle);
        }
        double square = (re * re + im * im) / n / n;
        weighted += k * width * square, all += square;
        if (k * width >= low && k * width < high) {
            inside += square;
            if (square > highest) highest = square, at = k * width;
        }
    }
    printf("mean %.1f Hz, share %.4f, line at %.1f Hz of %.4g\n", weighted / all, inside / all, at, sqrt(highest));
}
