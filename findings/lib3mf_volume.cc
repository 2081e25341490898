// SPDX-License-Identifier: MIT
// Prints corners, triangles and signed volume of what lib3mf 1.8 reads and merges: lib3mf_volume FORMAT FILE,
// FORMAT 3mf or stl, and the volume in units of the third argument, 1 without it.
#include <Model/COM/NMR_DLLInterfaces.h>
#include <cstdio>
#include <cstdlib>

using namespace NMR;

static void check(LIB3MFRESULT status) {
  if (status == 0) return;
  std::printf("error 0x%lx\n", static_cast<unsigned long>(status));
  std::exit(1);
}

static double volume_below(PLib3MFModelMeshObject* mesh, DWORD number) {
  MODELMESHTRIANGLE triangle;
  MODELMESHVERTEX vertex;
  double p[3][3];
  check(lib3mf_meshobject_gettriangle(mesh, number, &triangle));
  for (int k = 0; k < 3; ++k) {
    check(lib3mf_meshobject_getvertex(mesh, triangle.m_nIndices[k], &vertex));
    for (int d = 0; d < 3; ++d) p[k][d] = vertex.m_fPosition[d];
  }
  return (p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
          p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
          p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0])) /
         6;
}

int main(int count, char** arguments) {
  const double unit = count > 3 ? std::atof(arguments[3]) : 1;
  PLib3MFModel *model, *merged;
  PLib3MFModelReader* reader;
  PLib3MFModelResourceIterator* meshes;
  PLib3MFModelResource* mesh;
  BOOL more;
  DWORD corners, triangles;
  check(lib3mf_createmodel(&model));
  check(lib3mf_model_queryreader(model, arguments[1], &reader));
  check(lib3mf_reader_readfromfileutf8(reader, arguments[2]));
  check(lib3mf_model_mergetomodel(model, &merged));
  check(lib3mf_model_getmeshobjects(merged, &meshes));
  check(lib3mf_resourceiterator_movenext(meshes, &more));
  check(lib3mf_resourceiterator_getcurrent(meshes, &mesh));
  check(lib3mf_meshobject_getvertexcount(mesh, &corners));
  check(lib3mf_meshobject_gettrianglecount(mesh, &triangles));
  double volume = 0;
  for (DWORD i = 0; i < triangles; ++i) volume += volume_below(mesh, i);
  std::printf("%u corners, %u triangles, %.1f mm3\n", corners, triangles, volume / (unit * unit * unit));
}
