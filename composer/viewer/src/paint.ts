// Colors, materials and textures. Colors are as MuJoCo has them: numbers that go to the screen unchanged.
import {
  CanvasTexture,
  Color,
  CubeTexture,
  FrontSide,
  LinearFilter,
  LinearMipmapLinearFilter,
  MeshPhongMaterial,
  RepeatWrapping,
  type Texture,
  Vector2,
  Vector3,
} from "three";
import { type Model, row } from "./data";

export interface Paint {
  rgba: number[];
  material: number;
}

/** The color of a geom if it has one, otherwise the color of its material. */
export function colourOf(model: Model, rgba: number[], material: number): number[] {
  const unsaid = rgba.every((each) => each === 0.5 || each === 1) && rgba[0] === 0.5 && rgba[3] === 1;
  return material >= 0 && unsaid ? row(model.scene.material.rgba, material, 4) : rgba;
}

/** Images by the hash of their file, for every model that has them. */
const decoded = new Map<string, ImageBitmap>();

export class Painter {
  private readonly flat = new Map<number, Texture>();
  private readonly cubes = new Map<number, CubeTexture>();
  private readonly images = new Map<number, ImageBitmap>();

  constructor(private readonly model: Model) {}

  /** Decode the textures, because pictures that are drawn before lack them. */
  async load(): Promise<void> {
    await Promise.all(
      this.model.scene.texture.map(async (each, number) => {
        if (!decoded.has(each.blob)) {
          const blob = new Blob([this.model.blobs.get(each.blob)!], { type: "image/png" });
          decoded.set(
            each.blob,
            await createImageBitmap(blob, { colorSpaceConversion: "none", premultiplyAlpha: "none" }),
          );
        }
        this.images.set(number, decoded.get(each.blob)!);
      }),
    );
  }

  /** `size` is the size of a textured geom, on which its texture may depend; null if its surface has coordinates. */
  material(number: number, opacity: number, size: number[] | null, endless: boolean): MeshPhongMaterial {
    const paint = new MeshPhongMaterial({
      specular: new Color().setScalar(gloss(0.5, 64)),
      shininess: 64,
      side: FrontSide,
      transparent: opacity < 1 || endless,
      opacity,
      depthWrite: opacity >= 1,
    });
    if (number >= 0) {
      const { material, texture } = this.model.scene;
      paint.shininess = Math.max(1, material.shininess[number] * 128);
      paint.specular.setScalar(gloss(material.specular[number], paint.shininess));
      const emission = material.emission[number];
      if (emission > 0) {
        paint.emissive.setRGB(...(row(material.rgba, number, 3) as [number, number, number])).multiplyScalar(emission);
      }
      const image = material.texture[number];
      if (image >= 0) {
        const repeat = row(material.repeat, number, 2);
        const uniform = Boolean(material.uniform[number]);
        if (texture[image].kind === "2d") {
          this.flatten(paint, image, repeat, uniform, size, endless);
        } else {
          this.wrap(paint, image, uniform ? size : null);
        }
      }
    }
    if (endless) {
      fade(paint);
    }
    return paint;
  }

  private flatten(
    material: MeshPhongMaterial,
    image: number,
    repeat: number[],
    uniform: boolean,
    size: number[] | null,
    endless: boolean,
  ): void {
    material.map = this.texture(image);
    const key = `flat ${size} ${repeat} ${uniform}`;
    // Where the surface has no coordinates MuJoCo looks at it from above.
    const scale = new Vector2(repeat[0], repeat[1]);
    const half = size === null ? null : new Vector2(endless ? 1 : size[0], endless ? 1 : size[1]);
    if (half === null) {
      before(material, key, (shader) => {
        shader.uniforms.repeat = { value: scale };
        shader.vertexShader = shader.vertexShader
          .replace("#include <common>", "#include <common>\nuniform vec2 repeat;")
          .replace("#include <uv_vertex>", "#include <uv_vertex>\nvMapUv = uv * repeat;");
      });
      return;
    }
    const whole = new Vector2(0.5 * repeat[0], 0.5 * repeat[1]);
    if (uniform && !endless) {
      whole.multiply(half);
    }
    // A plane without an end has the middle of the image at its own middle, everything else a corner at its corner.
    const start = endless ? new Vector2(0.5, 0.5) : whole.clone();
    if (endless) {
      whole.multiplyScalar(size![2]);
    }
    before(material, key, (shader) => {
      shader.uniforms.whole = { value: whole };
      shader.uniforms.start = { value: start };
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", "#include <common>\nuniform vec2 whole, start;")
        .replace(
          "#include <uv_vertex>",
          "#include <uv_vertex>\nvMapUv = vec2(position.x, -position.y) * whole + start;",
        );
    });
  }

  private wrap(material: MeshPhongMaterial, image: number, size: number[] | null): void {
    const cube = this.cube(image);
    const stretch = size === null ? new Vector3(1, 1, 1) : new Vector3(...(size as [number, number, number]));
    before(material, `cube ${size}`, (shader) => {
      shader.uniforms.cube = { value: cube };
      shader.uniforms.stretch = { value: stretch };
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", "#include <common>\nuniform vec3 stretch;\nvarying vec3 vAway;")
        .replace("#include <begin_vertex>", "#include <begin_vertex>\nvAway = position * stretch;");
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", "#include <common>\nuniform samplerCube cube;\nvarying vec3 vAway;")
        .replace("#include <map_fragment>", "diffuseColor *= texture(cube, vAway);");
    });
  }

  private texture(number: number): Texture {
    let texture = this.flat.get(number);
    if (!texture) {
      texture = new CanvasTexture(this.images.get(number)! as any);
      texture.wrapS = texture.wrapT = RepeatWrapping;
      texture.anisotropy = 8;
      texture.flipY = false;
      texture.matrixAutoUpdate = false;
      // Rows of an image go down, coordinates go up.
      texture.minFilter = LinearMipmapLinearFilter;
      texture.magFilter = LinearFilter;
      this.flat.set(number, texture);
    }
    return texture;
  }

  /** The six faces of a texture, right, left, up, down, front and back, which are below each other. */
  cube(number: number): CubeTexture {
    let texture = this.cubes.get(number);
    if (!texture) {
      const { width, height } = this.model.scene.texture[number];
      const image = this.images.get(number)!;
      const faces = Math.max(1, Math.round(height / width));
      texture = new CubeTexture(
        Array.from({ length: 6 }, (_, face) => {
          const canvas = document.createElement("canvas");
          canvas.width = canvas.height = width;
          canvas.getContext("2d")!.drawImage(image, 0, width * (face % faces), width, width, 0, 0, width, width);
          return canvas;
        }) as any,
      );
      texture.needsUpdate = true;
      this.cubes.set(number, texture);
    }
    return texture;
  }

  sky(): CubeTexture | null {
    const number = this.model.scene.texture.findIndex((each) => each.kind === "skybox");
    return number < 0 ? null : this.cube(number);
  }

  dispose(): void {
    for (const texture of [...this.flat.values(), ...this.cubes.values()]) {
      texture.dispose();
    }
  }
}

/** The specular value of three.js, which it normalizes for the shininess; MuJoCo has plain Phong. */
const gloss = (specular: number, shininess: number): number => (LIGHT_SPECULAR * specular * 4) / (0.5 * shininess + 1);
const LIGHT_SPECULAR = 0.4;

/** Change the program of a material; `key` tells apart materials that differ in nothing else. */
function before(material: MeshPhongMaterial, key: string, change: (shader: any) => void): void {
  const previous = material.onBeforeCompile;
  const known = material.customProgramCacheKey();
  material.onBeforeCompile = (shader, renderer) => {
    previous.call(material, shader, renderer);
    change(shader);
  };
  material.customProgramCacheKey = () => `${known}|${key}`;
}

/** An infinite plane fades out toward the horizon. */
function fade(material: MeshPhongMaterial): void {
  before(material, "fade", (shader) => {
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nvarying float vOut;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvOut = length(position.xy);");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nvarying float vOut;")
      .replace(
        "#include <opaque_fragment>",
        "diffuseColor.a *= 1.0 - smoothstep(0.15, 1.0, vOut);\n#include <opaque_fragment>",
      );
  });
  material.depthWrite = true;
}
