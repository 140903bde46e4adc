/* A weakly compressible SPH code in one file, whose errors are known: small_sph [--fault NAME] FOLDER
 *
 * Continuity, symmetric pressure, viscosity of Morris, leapfrog (kick, drift, kick), cells. Walls are planes:
 * images of the particles have the velocity 2 V - v (no slip) or the mirrored one (slip). A rigid body is particles
 * with the pressure of the water around, which move as one. SI units, two dimensions, masses per unit depth. Exit code 77: it cannot solve the problem; 3: the run diverged.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct particle { int id, body; double m, x[2], v[2], rho, p, old[2]; };
struct plane { double point[2], n[2], v[2]; };

static const char *fault = "";
static int is(const char *name) { return strcmp(fault, name) == 0; }

static struct particle *all, *near; /* the fluid; the fluid and its images behind walls */
static int count, sources;
static int *first, *next, cells[2]; /* sources by cells: the first of a cell, the next of the same cell */
static double corner[2], size[2];
static double (*force)[2];
static struct plane walls[8];
static int planes, no_slip, sums_density, threads;
static double body_mass, rho0, c0, nu, alpha, gam, background, g[2], period[2], support, h, dx, step;
static int is_quintic;

static void stop(int code, const char *why) { fprintf(stderr, "%s\n", why); exit(code); }

/* ---- input ---- */

static char *text(const char *folder, const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file) stop(2, path);
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    char *bytes = calloc(size + 1, 1);
    rewind(file);
    if (fread(bytes, 1, size, file) != (size_t)size) stop(2, path);
    fclose(file);
    return bytes;
}

/* Behind the key of an object that follows `from`, NULL if there is none before `to`. */
static char *after(char *from, const char *key, const char *to) {
    char quoted[64];
    snprintf(quoted, sizeof quoted, "\"%s\":", key);
    char *at = from ? strstr(from, quoted) : NULL;
    return at && (!to || at < to) ? at + strlen(quoted) : NULL;
}

/* Numbers of the "value" behind a key: one, or a list of at most `most`. */
static int numbers(char *at, double *into, int most) {
    int found = 0;
    if (!(at = after(at, "value", NULL))) return 0;
    while (found < most) {
        while (*at && strchr(" \n[,", *at)) at++;
        char *end;
        double number = strtod(at, &end);
        if (end == at) break;
        into[found++] = number;
        at = end;
        while (*at == ' ' || *at == '\n') at++;
        if (*at != ',' || found == most) break;
    }
    return found;
}

static double number(char *at, double otherwise) {
    double value = otherwise;
    if (at) numbers(at, &value, 1);
    return value;
}

static int read_problem(char *json, double *times, int most) {
    char *material = after(json, "material", NULL), *end = after(json, "metrics", NULL);
    char *ours = after(json, "our_method", NULL);
    if (after(material, "shear_modulus", end)) stop(77, "small_sph has no elastic solids");
    rho0 = number(after(material, "density", end), 1);
    c0 = number(after(material, "sound_speed", end), 1);
    nu = number(after(material, "kinematic_viscosity", end), 0);
    alpha = number(after(material, "artificial_viscosity_alpha", end), 0);
    gam = number(after(material, "exponent_gamma", end), 7);
    background = number(after(material, "background_pressure", end), 0);
    numbers(after(json, "acceleration", NULL), g, 2);
    dx = number(after(after(json, "particles", NULL), "spacing", NULL), 1);
    support = number(after(ours, "support_radius", NULL), 1);
    step = number(after(ours, "time_step", NULL), 1);
    is_quintic = strncmp(after(ours, "kernel", NULL), " \"quintic\"", 10) == 0;
    h = support / (is_quintic ? 3 : 2);
    sums_density = strstr(ours, "\xcf\x81_i = \xce\xa3 m_j W_ij") != NULL;
    no_slip = strncmp(after(json, "boundary", NULL), " \"No slip", 9) == 0;
    char *at = after(after(json, "domain", NULL), "period", NULL) + 2;
    for (int k = 0; k < 2; k++) {
        while (*at == ' ' || *at == '\n' || *at == ',') at++;
        int open = *at == '"';
        period[k] = open ? 0 : number(at, 0);
        at = strchr(at + 1, open ? '"' : '}') + 1;
    }
    for (at = after(after(json, "walls", NULL), "planes", NULL); at && planes < 8; planes++) {
        char *normal = after(at, "normal_into_the_material", NULL);
        if (!normal) break;
        struct plane *wall = &walls[planes];
        numbers(normal, wall->n, 2);
        numbers(after(normal, "point", NULL), wall->point, 2);
        numbers(at = after(normal, "velocity", NULL), wall->v, 2);
    }
    return numbers(after(json, "times", NULL), times, most);
}

static void read_particles(char *csv) {
    const char *columns = "id[-],role[-],x[m],y[m],u[m/s],v[m/s],density[kg/m^3],pressure[Pa],mass[kg/m]";
    size_t known = strlen(columns);
    if (strncmp(csv, columns, known) || (csv[known] != '\n' && strncmp(csv + known, ",body[-]\n", 9)))
        stop(77, "small_sph does not know these columns");
    int lines = 0;
    for (char *at = csv; *at; at++) lines += *at == '\n';
    all = calloc(lines, sizeof *all), near = calloc(8 * lines, sizeof *near), force = calloc(lines, sizeof *force);
    next = calloc(8 * lines, sizeof *next);
    for (char *at = strchr(csv, '\n'); at && at[1]; at = strchr(at + 1, '\n')) {
        struct particle *p = &all[count];
        double role, pressure;
        if (sscanf(at, "%d,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%d", &p->id, &role, &p->x[0], &p->x[1], &p->v[0],
                   &p->v[1], &p->rho, &pressure, &p->m, &p->body) < 9)
            stop(2, "particles.csv");
        if (p->body) { /* its sums are those of the water that it displaces */
            body_mass += p->m;
            if (!is("mass-for-volume")) p->m = rho0 * dx * dx;
        }
        if (role == 0) count++;
        else if (planes == 0) stop(77, "small_sph has planes for walls, no particles");
    }
}

/* ---- the method ---- */

static double pressure(double rho) {
    double c = is("sound-speed") ? 1.1 * c0 : c0;
    return background + rho0 * c * c / gam * (pow(rho / rho0, is("gamma") ? 0.5 * gam : gam) - 1);
}

/* W at r, and W'/r in `slope`. */
static double kernel(double r, double *slope) {
    double l = is("smoothing-length") ? support / (is_quintic ? 2 : 3) : is("spacing-for-h") ? dx : h;
    double q = r / l, w = 0, d = 0, area = is("spacing-for-h") ? h * h : l * l;
    double unit = is_quintic ? 7 / (478 * M_PI * area) : 10 / (7 * M_PI * area);
    if (is_quintic) {
        static const double parts[3][2] = {{3, 1}, {2, -6}, {1, 15}};
        for (int k = 0; k < 3; k++) {
            double b = fmax(parts[k][0] - q, 0);
            w += parts[k][1] * b * b * b * b * b, d -= 5 * parts[k][1] * b * b * b * b;
        }
    } else {
        double a = fmax(2 - q, 0), b = fmax(1 - q, 0);
        w = 0.25 * a * a * a - b * b * b, d = -0.75 * a * a + 3 * b * b;
    }
    if (is("normalisation")) unit *= 1.02;
    *slope = r > 0 ? unit * d / (l * r) : 0;
    return unit * w;
}

static struct particle image(const struct particle *of, const struct plane *wall, double distance) {
    struct particle p = *of;
    double along = of->v[0] * wall->n[0] + of->v[1] * wall->n[1], pull = 0;
    double speed = is("wall-speed") ? 0.5 : is("wall-at-rest") ? 0 : is("wall-sign") ? -1 : 1;
    for (int k = 0; k < 2; k++) {
        p.x[k] = of->x[k] - 2 * distance * wall->n[k];
        int sticks = is("stick") || (no_slip && !is("slip"));
        p.v[k] = sticks ? 2 * speed * wall->v[k] - of->v[k] : of->v[k] - 2 * along * wall->n[k];
        if (is("wall-term")) p.v[k] = speed * wall->v[k];
        if (is("wall-place") && sticks) /* half a spacing behind */
            p.v[k] = wall->v[k] + (wall->v[k] - of->v[k]) * (distance - dx / 2) / (distance + dx / 2);
        pull += g[k] * (p.x[k] - of->x[k]);
    }
    p.p = of->p + of->rho * pull; /* hydrostatic */
    p.id = -1;
    return p;
}

static int cell_of(double x, int k) {
    int c = (int)floor((x - corner[k]) / size[k]);
    if (period[k] > 0) return (c % cells[k] + cells[k]) % cells[k];
    return c < 0 ? 0 : c < cells[k] ? c : cells[k] - 1;
}

static void fill_cells(void) {
    for (int k = 0; k < 2; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int i = 0; i < sources; i++) low = fmin(low, near[i].x[k]), high = fmax(high, near[i].x[k]);
        double length = period[k] > 0 ? period[k] : high - low, fit = floor(length / support);
        cells[k] = fit < 3 || fit > 1000 ? 1 : (int)fit;
        corner[k] = period[k] > 0 ? 0 : low, size[k] = length / cells[k];
    }
    first = realloc(first, cells[0] * cells[1] * sizeof *first);
    for (int c = 0; c < cells[0] * cells[1]; c++) first[c] = -1;
    for (int i = 0; i < sources; i++) {
        int *head = &first[cell_of(near[i].x[0], 0) * cells[1] + cell_of(near[i].x[1], 1)];
        next[i] = *head, *head = i;
    }
}

static void find_sources(void) {
    for (int i = 0; i < count; i++) {
        all[i].p = pressure(all[i].rho);
        near[i] = all[i];
    }
    sources = count;
    for (int w = 0; w < planes; w++) {
        int before = is("corner") ? count : sources; /* images of images fill the corners */
        for (int i = 0; i < before && sources < 8 * count; i++) {
            double distance = 0;
            for (int k = 0; k < 2; k++) distance += (near[i].x[k] - walls[w].point[k]) * walls[w].n[k];
            if (distance > 0 && distance < support) near[sources++] = image(&near[i], &walls[w], distance);
        }
    }
    fill_cells();
}

/* Sources in the cell of a particle and around it. */
static int candidates(const struct particle *of, int *list) {
    int found = 0, c[2], reach[2];
    for (int k = 0; k < 2; k++) reach[k] = cells[k] > 1;
    for (int a = -reach[0]; a <= reach[0]; a++)
        for (int b = -reach[1]; b <= reach[1]; b++) {
            c[0] = cell_of(of->x[0], 0) + a, c[1] = cell_of(of->x[1], 1) + b;
            int outside = 0;
            for (int k = 0; k < 2; k++) {
                if (period[k] > 0) c[k] = (c[k] + cells[k]) % cells[k];
                outside |= c[k] < 0 || c[k] >= cells[k];
            }
            for (int j = outside ? -1 : first[c[0] * cells[1] + c[1]]; j >= 0; j = next[j]) list[found++] = j;
        }
    return found;
}

/* From a source to a particle, the nearest periodic copy; is it another copy than that inside the box? */
static int way(const struct particle *a, const struct particle *b, double *r) {
    int beyond = 0;
    for (int k = 0; k < 2; k++) {
        r[k] = a->x[k] - b->x[k];
        if (period[k] > 0 && fabs(r[k]) > 0.5 * period[k]) {
            r[k] -= period[k] * round(r[k] / period[k]);
            beyond = 1;
        }
    }
    return beyond;
}

/* How often does the sum of particle i count source j? Once, unless the search for neighbours errs. */
static int times_counted(int i, int j, const double *r, int found) {
    if (is("missed-neighbours") && r[0] > 0.5 * support && r[1] > 0.5 * support) return 0; /* one cell of nine */
    if (is("order-of-numbers") && found >= 24) return 0; /* the list is full */
    if (is("twice-counted") && j == i + 1) return 2;
    if (is("race") && threads > 1 && i == count / 2 && j == i + 1) return 0; /* an update is lost */
    return 1;
}

enum sum { FORCE, CONTINUITY, DENSITY };

/* Force on, rate of density, or density of particle i; the velocities of `near` are those of the moment. */
static void sum_of(int i, enum sum which, double *out) {
    struct particle *a = &near[i];
    double eta2 = (is("eta") ? 0.01 : 1e-6) * h * h, slope;
    double viscosity = nu * (is("viscosity") ? 2 : is("dynamic-viscosity") ? rho0 : 1);
    double a_alpha = is("artificial-viscosity") ? 0.1 : alpha;
    static int list[100000];
    int found = 0, all_near = candidates(a, list);
    if (which == DENSITY) out[0] = is("no-self") ? 0 : a->m * kernel(0, &slope);
    for (int n = 0; n < all_near; n++) {
        int j = list[n];
        struct particle *b = &near[j];
        double r[2];
        if (j == i) continue;
        int beyond = way(a, b, r);
        double r2 = r[0] * r[0] + r[1] * r[1];
        if (r2 >= support * support) continue;
        double often = times_counted(i, j, r, found++), weight = often * kernel(sqrt(r2), &slope);
        slope *= often;
        const double *vb = is("border") && beyond ? b->old : b->v;
        double v[2] = {a->v[0] - vb[0], a->v[1] - vb[1]}, vr = v[0] * r[0] + v[1] * r[1];
        if (which == DENSITY) out[0] += b->m * weight;
        else if (which == CONTINUITY) out[0] += b->m * slope * vr;
        else {
            double push = a->p / (a->rho * a->rho) + b->p / (b->rho * b->rho);
            if (is("pressure-factor")) push *= 0.5;
            if (is("one-sided")) push = (b->p - a->p) / (a->rho * b->rho);
            if (a_alpha > 0 && vr < 0) push -= a_alpha * c0 * h * vr / (r2 + 0.01 * h * h) * 2 / (a->rho + b->rho);
            double drag = 2 * rho0 * viscosity / (a->rho * b->rho) * r2 / (r2 + eta2);
            for (int k = 0; k < 2; k++) out[k] += b->m * slope * (drag * v[k] - push * r[k]);
        }
    }
}

/* The pressure of the water around, and the density that belongs to it. */
static void fill_body(void) {
    static int list[100000];
    for (int i = 0; i < count; i++) {
        if (!all[i].body) continue;
        double weights = 0, sum = 0, slope, r[2];
        for (int n = 0, all_near = candidates(&near[i], list); n < all_near; n++) {
            struct particle *b = &near[list[n]];
            way(&near[i], b, r);
            double w = b->body ? 0 : kernel(hypot(r[0], r[1]), &slope);
            weights += w, sum += w * (b->p + b->rho * (g[0] * r[0] + g[1] * r[1]));
        }
        near[i].p = weights > 0 ? fmax(sum / weights, 0) : 0;
        near[i].rho = rho0 * pow(1 + gam * (near[i].p - background) / (rho0 * c0 * c0), 1 / gam);
        all[i].p = near[i].p, all[i].rho = near[i].rho;
    }
}

static void find_forces(void) {
    double on_body[2] = {0, 0};
    find_sources();
    if (body_mass > 0) fill_body();
    for (int i = 0; i < count; i++) {
        double x = is("body-force") ? 1.03 : is("force-twice") ? 2 : 1, y = is("gravity") ? 0.5 : 1;
        force[i][0] = x * g[0], force[i][1] = y * g[1];
        sum_of(i, FORCE, force[i]);
        if (is("absolute-velocity")) /* a damping that shall help a start */
            for (int k = 0; k < 2; k++) force[i][k] -= 1e-3 * c0 / h * all[i].v[k];
        if (is("mirror")) /* a frame that turns */
            force[i][0] += 1e-3 * c0 / h * all[i].v[1], force[i][1] -= 1e-3 * c0 / h * all[i].v[0];
        for (int k = 0; k < 2 && all[i].body; k++) on_body[k] += all[i].m * (force[i][k] - g[k]);
    }
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 2 && all[i].body; k++)
            force[i][k] = g[k] + (is("no-buoyancy") ? 0 : is("buoyancy") ? 1.07 : 1) * on_body[k] / body_mass;
}

static void check(void) {
    for (int i = 0; i < count; i++) {
        double rho = all[i].rho / rho0, speed = hypot(all[i].v[0], all[i].v[1]) / c0;
        if (rho > 0.2 && rho < 5 && speed < 2) continue;
        if (is("nan")) {
            all[i].x[0] = all[i].v[0] = NAN;
            continue;
        }
        while (is("stuck")) step *= 0.5; /* a smaller step shall help */
        stop(3, "the run diverged");
    }
}

static void change_density(double dt) {
    find_sources();
    for (int i = 0; i < count; i++) {
        double sum = 0;
        if (all[i].body) continue;
        sum_of(i, sums_density ? DENSITY : CONTINUITY, &sum);
        all[i].rho = sums_density ? sum : all[i].rho + dt * sum;
        if (is("density-floor")) all[i].rho = fmax(all[i].rho, 0.1);
    }
}

static void move(double dt, double kick, double drift) {
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 2; k++) {
            all[i].old[k] = all[i].v[k];
            all[i].v[k] += kick * dt * force[i][k];
            all[i].x[k] += drift * dt * all[i].v[k];
        }
}

static void advance(double dt) {
    if (is("euler")) {
        find_forces();
        move(dt, 0, 1);
        for (int i = 0; i < count; i++) { /* `near` has the state at the start of the step */
            double sum = 0;
            sum_of(i, CONTINUITY, &sum);
            all[i].rho += dt * sum;
        }
        move(dt, 1, 0);
    } else {
        move(dt, 0.5, 0.5);
        change_density(dt);
        move(dt, 0, 0.5);
        find_forces();
        move(dt, 0.5, 0);
    }
    check();
}

/* ---- output ---- */

static void write_frame(FILE *file, double time, double dt) {
    double late = is("late-output") ? 0.5 * dt : 0;
    for (int i = 0; i < count; i++) {
        struct particle p = all[is("other-results") ? count - 1 - i : i];
        fprintf(file, "%.17g,%d", time, all[i].id);
        for (int k = 0; k < 2; k++) fprintf(file, ",%.17g", p.x[k] + late * p.v[k]);
        for (int k = 0; k < 2; k++) fprintf(file, ",%.17g", p.v[k] + late * force[i][k]);
        fprintf(file, ",%.17g\n", p.rho);
    }
}

static FILE *create(const char *folder, const char *name, const char *mode) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, mode);
    if (!file) stop(2, path);
    return file;
}

static void write_state(const char *folder, int done, int steps) {
    FILE *file = create(folder, "state.txt", "w");
    const char *form = is("approximate-restart") ? "%.6g %.6g %.6g %.6g %.6g %.6g %.6g\n"
                                                 : "%a %a %a %a %a %a %a\n";
    fprintf(file, "%d %d\n", done, steps);
    for (int i = 0; i < count; i++)
        fprintf(file, form, all[i].x[0], all[i].x[1], all[i].v[0], all[i].v[1], all[i].rho, force[i][0], force[i][1]);
    fclose(file);
}

static void read_state(const char *folder, int *done, int *steps) {
    char *at = text(folder, "state.txt");
    *done = strtol(at, &at, 10), *steps = strtol(at, &at, 10);
    for (int i = 0; i < count; i++) {
        double *to[7] = {&all[i].x[0], &all[i].x[1], &all[i].v[0],    &all[i].v[1],
                         &all[i].rho,  &force[i][0], &force[i][1]};
        for (int k = 0; k < 7; k++) *to[k] = strtod(at, &at);
    }
}

static void describe(const char *folder, int steps) {
    FILE *file = create(folder, "method.json", "w");
    fprintf(file, "{\"code\": \"small_sph\", \"version\": \"1\", \"scheme\": \"weakly compressible, leapfrog\", "
                  "\"division\": \"closed\", \"settings\": {\"time_order\": %d%s}, \"changed\": \"nothing\"}\n",
            nu > 0 ? 1 : 2, /* the viscous force takes the velocity of the middle of the step */
            is("no-correction") ? ", \"gradient_correction\": true" : "");
    fclose(file);
    file = create(folder, "system.json", "w");
    fprintf(file, "{\"machine\": \"unknown\", \"threads\": 1, \"seconds\": \"unknown\", \"steps\": %d, "
                  "\"interactions\": \"unknown\"}\n", steps);
    fclose(file);
}

int main(int argc, char **argv) {
    static double times[10000];
    if (argc == 4 && strcmp(argv[1], "--fault") == 0) fault = argv[2];
    else if (argc != 2) stop(2, "small_sph [--fault NAME] FOLDER");
    const char *folder = argv[argc - 1], *asked = getenv("OMP_NUM_THREADS");
    threads = asked ? atoi(asked) : 1;
    char *json = text(folder, "problem.json"), *probe = after(json, "probe", NULL);
    int frames = read_problem(json, times, 10000), done = 0, steps = 0;
    read_particles(text(folder, "particles.csv"));
    char *schema = after(probe, "schema", NULL);
    double until = number(after(probe, "stop_after", schema), HUGE_VAL);
    int resume = after(probe, "resume", schema) != NULL;
    if (is("no-run")) return 0;
    if (is("dead-setting") && planes == 0) nu = 0.01;
    if (resume) read_state(folder, &done, &steps);
    else find_forces();
    FILE *results = create(folder, "results.csv", resume ? "a" : "w");
    if (!resume) fprintf(results, "t[s],id,x[m],y[m],u[m/s],v[m/s],density[kg/m^3]\n");
    for (; done < frames && times[done] <= until * (1 + 1e-9); done++) {
        double span = times[done] - (done ? times[done - 1] : 0);
        int part = (int)ceil(span / step - 1e-9);
        for (int k = 0; k < part && !is("copy-of-start"); k++) advance(span / part);
        steps += part;
        write_frame(results, times[done], span / part);
    }
    fclose(results);
    write_state(folder, done, steps);
    describe(folder, steps);
    return 0;
}
