// Particles as files of DualSPHysics, by its own classes; z of the code is y of the problem:
// bi4 write CASE < particles and bi4 read FOLDER PART > particles
#include "JPartDataBi4.h"
#include <cstdio>
#include <string>
#include <vector>

static void numbers(double *to, int count) {
    for (int k = 0; k < count; k++)
        if (scanf("%lf", to + k) != 1) throw 1;
}

static void write(const char *name) {
    double of[10]; // dp, h, b, rho, gamma, mass, low corner, high corner
    numbers(of, 10);
    unsigned fixed, moving, fluid;
    if (scanf("%u %u %u", &fixed, &moving, &fluid) != 3) throw 1;
    const unsigned count = fixed + moving + fluid;
    std::vector<unsigned> id(count);
    std::vector<tdouble3> place(count);
    std::vector<tfloat3> velocity(count), normal(count);
    std::vector<float> density(count);
    for (unsigned k = 0; k < count; k++) {
        double row[7]; // x, z, u, w, density, from the particle to the wall
        numbers(row, 7);
        id[k] = k;
        place[k] = TDouble3(row[0], 0, row[1]);
        velocity[k] = TFloat3(float(row[2]), 0, float(row[3]));
        density[k] = float(row[4]);
        normal[k] = TFloat3(float(row[5]), 0, float(row[6]));
    }
    const tdouble3 low = TDouble3(of[6], -of[1], of[7]), high = TDouble3(of[8], of[1], of[9]);
    JPartDataBi4 data;
    data.ConfigBasic(0, 1, "touchstone", "touchstone", name, true, 0, "");
    data.ConfigParticles(count, fixed, moving, 0, fluid, low, high, false, false);
    data.ConfigCtes(of[0], of[1], of[2], of[3], of[4], of[5], of[5]);
    data.ConfigSimMap(low, high);
    data.AddPartInfo(0, 0, count, 0, 0, 0, low, high, 0, 0);
    data.AddPartData(count, id.data(), place.data(), velocity.data(), density.data(), false);
    if (fixed + moving) data.AddPartData("BoundNor", fixed + moving, normal.data(), false);
    data.SaveFileCase(name);
}

static void read(const char *folder, unsigned part) {
    JPartDataBi4 data;
    data.LoadFilePart(folder, part);
    const unsigned count = data.Get_Npok();
    std::vector<unsigned> id(count);
    std::vector<tdouble3> place(count);
    std::vector<tfloat3> velocity(count);
    std::vector<float> density(count);
    data.Get_Idp(count, id.data());
    data.Get_Posd(count, place.data());
    data.Get_Vel(count, velocity.data());
    data.Get_Rhop(count, density.data());
    printf("%.17g %u\n", data.Get_TimeStep(), data.GetPart()->GetvUint("Step"));
    for (unsigned k = 0; k < count; k++)
        printf("%u %.17g %.17g %.9g %.9g %.9g\n", id[k], place[k].x, place[k].z, velocity[k].x, velocity[k].z,
               density[k]);
}

int main(int count, char **words) {
    try {
        if (count == 3 && std::string(words[1]) == "write") write(words[2]);
        else if (count == 4 && std::string(words[1]) == "read") read(words[2], std::stoul(words[3]));
        else return 2;
    } catch (int) {
        fprintf(stderr, "particles cannot be read\n");
        return 1;
    }
    return 0;
}
