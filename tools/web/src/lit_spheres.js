// White spheres in the cells of a volume, which its light makes visible.
import {InstancedMesh, Matrix4, MeshLambertMaterial, SphereGeometry, Vector3} from 'three';

/** Most spheres along an axis. */
const MOST = 24;

export class LitSpheres extends InstancedMesh {
  /** `volume`: a light with a boundingBox, and a grid or a resolution. */
  constructor({boundingBox: {min, max}, grid, resolution}) {
    const cells = (grid ?? resolution.toArray()).map((side) => Math.min(side, MOST));
    const size = new Vector3().subVectors(max, min).divide(new Vector3(...cells));
    super(new SphereGeometry(Math.min(size.x, size.y, size.z) / 6, 16, 12), new MeshLambertMaterial(), cells[0] * cells[1] * cells[2]);
    const matrix = new Matrix4(), at = new Vector3();
    for (let i = 0; i < this.count; ++i) {
      at.set(i % cells[0], Math.floor(i / cells[0]) % cells[1], Math.floor(i / (cells[0] * cells[1])));
      this.setMatrixAt(i, matrix.makeTranslation(at.addScalar(0.5).multiply(size).add(min)));
    }
  }

  dispose() {
    this.removeFromParent();
    this.geometry.dispose();
    this.material.dispose();
    super.dispose();
  }
}
