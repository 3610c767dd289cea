<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="fr_FR" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>AI model:</source>
        <translation>Modèle d'IA :</translation>
    </message>
    <message>
        <source>AI models (*.onnx)</source>
        <translation>Modèles d'IA (*.onnx)</translation>
    </message>
    <message>
        <source>AI output:</source>
        <translation>Résultat de l'IA :</translation>
    </message>
    <message>
        <source>AI stream:</source>
        <translation>Flux de l'IA :</translation>
    </message>
    <message>
        <source>An AI model (a neural network) that says where bone is in a frame, as an ONNX file. It is run on this computer's processor, and nothing but this file and the JSON of its name is opened.</source>
        <translation>Un modèle d'IA (un réseau de neurones) qui dit où est l'os dans une image, dans un fichier ONNX. Il tourne sur le processeur de cet ordinateur, et seuls ce fichier et le JSON de son nom sont ouverts.</translation>
    </message>
    <message>
        <source>Bone of CT:</source>
        <translation>Os de la TDM :</translation>
    </message>
    <message>
        <source>Bone told by:</source>
        <translation>Os indiqué par :</translation>
    </message>
    <message>
        <source>CT:</source>
        <translation>TDM :</translation>
    </message>
    <message>
        <source>Connection</source>
        <translation>Connexion</translation>
    </message>
    <message>
        <source>Live</source>
        <translation>En direct</translation>
    </message>
    <message>
        <source>More</source>
        <translation>Plus</translation>
    </message>
    <message>
        <source>More sweeps:</source>
        <translation>Autres balayages :</translation>
    </message>
    <message>
        <source>Name under which the server sends what an AI model says (device), with the time stamps of its images</source>
        <translation>Nom sous lequel le serveur envoie ce que dit un modèle d'IA (appareil), avec les horodatages de ses images</translation>
    </message>
    <message>
        <source>None</source>
        <translation>Aucun</translation>
    </message>
    <message>
        <source>None yet</source>
        <translation>Aucun pour l'instant</translation>
    </message>
    <message>
        <source>Open recording, CT, segmentation...</source>
        <translation>Ouvrir enregistrement, TDM, segmentation...</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pause</translation>
    </message>
    <message>
        <source>Place CT on sweep</source>
        <translation>Placer la TDM sur le balayage</translation>
    </message>
    <message>
        <source>Reconstruct</source>
        <translation>Reconstruire</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>Enregistrer</translation>
    </message>
    <message>
        <source>Recorded</source>
        <translation>Enregistré</translation>
    </message>
    <message>
        <source>Say where to move next</source>
        <translation>Dire où aller ensuite</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Réglages</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Démarrer</translation>
    </message>
    <message>
        <source>Start over...</source>
        <translation>Recommencer...</translation>
    </message>
    <message>
        <source>Stop</source>
        <translation>Arrêter</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Balayage et TDM</translation>
    </message>
    <message>
        <source>Sweep:</source>
        <translation>Balayage :</translation>
    </message>
    <message>
        <source>Try it on a sample patient</source>
        <translation>Essayer sur un patient fictif</translation>
    </message>
    <message>
        <source>Use the scanned area</source>
        <translation>Prendre la zone balayée</translation>
    </message>
    <message>
        <source>Vertebrae:</source>
        <translation>Vertèbres :</translation>
    </message>
    <message>
        <source>What an AI model has said of the frames (predictions): a sequence of images, one for each frame or with their times, from 0 to 255 or from 0 to 1</source>
        <translation>Ce qu'un modèle d'IA a dit des images (prédictions) : une séquence d'images, une par image ou avec leurs temps, de 0 à 255 ou de 0 à 1</translation>
    </message>
    <message>
        <source>Who says where bone is: the CT in its place, an AI model (a neural network) that looks at every frame, or the echoes, bright with darkness behind them. Only the CT knows bone that no frame shows.</source>
        <translation>Qui dit où est l'os : la TDM à sa place, un modèle d'IA (un réseau de neurones) qui regarde chaque image, ou les échos, clairs avec de l'obscurité derrière. Seule la TDM connaît l'os qu'aucune image ne montre.</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>pas démarré</translation>
    </message>
</context>
<context>
    <name>AIFReconGui.packages</name>
    <message>
        <source>An AI model in a file needs the Python package onnxruntime, a download from the internet. Install it now?</source>
        <translation>Un modèle d'IA dans un fichier a besoin du paquet Python onnxruntime, à télécharger sur Internet. L'installer maintenant ?</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>Bone is known from {looked} of {frames} frames.</source>
        <translation>L'os est connu par {looked} images sur {frames}.</translation>
    </message>
    <message>
        <source>CT agrees but for {bones}: {found}</source>
        <translation>La TDM concorde sauf pour {bones} : {found}</translation>
    </message>
    <message>
        <source>CT agrees: {found}</source>
        <translation>La TDM concorde : {found}</translation>
    </message>
    <message>
        <source>CT does not agree: {found}</source>
        <translation>La TDM ne concorde pas : {found}</translation>
    </message>
    <message>
        <source>Do not trust the picture there, nor the names of the levels: the spine may have bent since the CT, or the CT lies one level off.</source>
        <translation>Ne vous fiez là ni à l'image ni aux noms des niveaux : le rachis a pu se courber depuis la TDM, ou la TDM est décalée d'un niveau.</translation>
    </message>
    <message>
        <source>Move the probe more slowly: {fast:.0f} mm/s at most.</source>
        <translation>Déplacez la sonde plus lentement : {fast:.0f} mm/s au plus.</translation>
    </message>
    <message>
        <source>Place the CT on the sweep before you believe the picture.</source>
        <translation>Placez la TDM sur le balayage avant de croire l'image.</translation>
    </message>
    <message>
        <source>Scan {name} again, from other angles.</source>
        <translation>Balayez encore {name}, sous d'autres angles.</translation>
    </message>
    <message>
        <source>expected to show: {shares}</source>
        <translation>devrait être visible : {shares}</translation>
    </message>
    <message>
        <source>known after “Reconstruct”</source>
        <translation>connu après « Reconstruire »</translation>
    </message>
    <message>
        <source>no sweep yet</source>
        <translation>pas encore de balayage</translation>
    </message>
    <message>
        <source>onnxruntime was not installed, and an AI model in a file needs it: {why}</source>
        <translation>onnxruntime n'a pas été installé, et un modèle d'IA dans un fichier en a besoin : {why}</translation>
    </message>
    <message>
        <source>{count} predictions belong to no frame with a pose.</source>
        <translation>{count} prédictions n'appartiennent à aucune image avec une pose.</translation>
    </message>
    <message>
        <source>{frames}, probe at {speed:.0f} mm/s</source>
        <translation>{frames}, sonde à {speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{packages} is not installed, and an AI model in a file needs it.</source>
        <translation>{packages} n'est pas installé, et un modèle d'IA dans un fichier en a besoin.</translation>
    </message>
    <message>
        <source>{share:.0%} of the echoes lie on its bone, {median:.1f} mm off in the median</source>
        <translation>{share:.0%} des échos sont sur son os, à {median:.1f} mm en médiane</translation>
    </message>
    <message>
        <source>{used} of {frames} frames</source>
        <translation>{used} images sur {frames}</translation>
    </message>
</context>
<context>
    <name>AIFReconScene.panelWords</name>
    <message>
        <source>The echoes themselves</source>
        <translation>Les échos eux-mêmes</translation>
    </message>
    <message>
        <source>The output of the AI model belongs to one sweep; got {predictions} for {sweeps}. Leave the others out.</source>
        <translation>Le résultat du modèle d'IA appartient à un balayage ; il y en a {predictions} pour {sweeps}. Laissez les autres de côté.</translation>
    </message>
    <message>
        <source>{name}: predictions of {got} pixels do not fit frames of {frames}. Select what the AI model has said of this sweep, in its size.</source>
        <translation>{name} : des prédictions de {got} pixels ne vont pas avec des images de {frames}. Choisissez ce que le modèle d'IA a dit de ce balayage, à sa taille.</translation>
    </message>
</context>
<context>
    <name>Picture</name>
    <message>
        <source>Research use only: not for guiding a needle.</source>
        <translation>Pour la recherche seulement : pas pour guider une aiguille.</translation>
    </message>
</context>
<context>
    <name>inputs.boneSource</name>
    <message>
        <source>An AI model in a file</source>
        <translation>Un modèle d'IA dans un fichier</translation>
    </message>
    <message>
        <source>An AI model that runs elsewhere</source>
        <translation>Un modèle d'IA qui tourne ailleurs</translation>
    </message>
    <message>
        <source>An AI model, as it was recorded</source>
        <translation>Un modèle d'IA, tel qu'enregistré</translation>
    </message>
    <message>
        <source>Bone is looked for in the sweep itself: what is bright with darkness behind it. The docs say how well that works.</source>
        <translation>L'os est cherché dans le balayage même : ce qui est clair avec de l'obscurité derrière. La documentation dit ce que cela vaut.</translation>
    </message>
    <message>
        <source>Choose the file of the AI model, or choose another “Bone told by”.</source>
        <translation>Choisissez le fichier du modèle d'IA, ou un autre « Os indiqué par ».</translation>
    </message>
    <message>
        <source>Enter the name under which the server sends what the AI model says, or choose another “Bone told by”.</source>
        <translation>Entrez le nom sous lequel le serveur envoie ce que dit le modèle d'IA, ou choisissez un autre « Os indiqué par ».</translation>
    </message>
    <message>
        <source>Every label above 0 is bone.</source>
        <translation>Toute étiquette supérieure à 0 est de l'os.</translation>
    </message>
    <message>
        <source>Images and what the AI model says of them must have two names; both are {name}.</source>
        <translation>Les images et ce que le modèle d'IA en dit doivent avoir deux noms ; les deux s'appellent {name}.</translation>
    </message>
    <message>
        <source>No bone selected: the sweep is averaged, and bone is not enhanced.</source>
        <translation>Aucun os choisi : le balayage est moyenné, et l'os n'est pas rehaussé.</translation>
    </message>
    <message>
        <source>Select the recorded output of the AI model, or choose another “Bone told by”.</source>
        <translation>Choisissez le résultat enregistré du modèle d'IA, ou un autre « Os indiqué par ».</translation>
    </message>
    <message>
        <source>Taken for the probability of bone, from 0 to 1.</source>
        <translation>Pris pour la probabilité d'os, de 0 à 1.</translation>
    </message>
    <message>
        <source>The CT</source>
        <translation>Le CT</translation>
    </message>
    <message>
        <source>The echoes themselves</source>
        <translation>Les échos eux-mêmes</translation>
    </message>
    <message>
        <source>The output of the AI model belongs to one sweep: leave the others out, or choose another “Bone told by”.</source>
        <translation>Le résultat du modèle d'IA appartient à un seul balayage : laissez les autres de côté, ou choisissez un autre « Os indiqué par ».</translation>
    </message>
    <message>
        <source>There is no file {path}.</source>
        <translation>Il n'y a pas de fichier {path}.</translation>
    </message>
    <message>
        <source>What an AI model says comes from a server: take the images from there too, or choose another “Bone told by”.</source>
        <translation>Ce que dit un modèle d'IA vient d'un serveur : prenez-y aussi les images, ou choisissez un autre « Os indiqué par ».</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Open a recording, or select a tracked sweep.</source>
        <translation>Ouvrez un enregistrement ou choisissez un balayage.</translation>
    </message>
</context>
<context>
    <name>panel.lights</name>
    <message>
        <source>Coverage</source>
        <translation>Couverture</translation>
    </message>
    <message>
        <source>Registration</source>
        <translation>Recalage</translation>
    </message>
    <message>
        <source>Tracking</source>
        <translation>Suivi</translation>
    </message>
    <message>
        <source>being worked out ...</source>
        <translation>calcul en cours...</translation>
    </message>
</context>
<context>
    <name>panel.livePanel</name>
    <message>
        <source>Press Start</source>
        <translation>Appuyez sur Démarrer</translation>
    </message>
    <message>
        <source>What the AI model said is in {path}.</source>
        <translation>Ce que le modèle d'IA a dit est dans {path}.</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>pas démarré</translation>
    </message>
    <message>
        <source>stopped</source>
        <translation>arrêté</translation>
    </message>
</context>
<context>
    <name>panel.liveWords</name>
    <message>
        <source>Bring what is not seen into the tracker's view</source>
        <translation>Mettez dans le champ du traqueur ce qu'il ne voit pas</translation>
    </message>
    <message>
        <source>Keep scanning</source>
        <translation>Continuez à balayer</translation>
    </message>
    <message>
        <source>Probe seen</source>
        <translation>Sonde vue</translation>
    </message>
</context>
<context>
    <name>panel.recordedPanel</name>
    <message>
        <source>Done.</source>
        <translation>Terminé.</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Balayage et TDM</translation>
    </message>
    <message>
        <source>Sweep and CT: {names}</source>
        <translation>Balayage et TDM : {names}</translation>
    </message>
</context>
<context>
    <name>panel.signals</name>
    <message>
        <source>caution</source>
        <translation>prudence</translation>
    </message>
    <message>
        <source>good</source>
        <translation>bon</translation>
    </message>
    <message>
        <source>not yet</source>
        <translation>pas encore</translation>
    </message>
    <message>
        <source>poor</source>
        <translation>mauvais</translation>
    </message>
</context>
<context>
    <name>picture.sweepPage</name>
    <message>
        <source>Research use only: not for guiding a needle.</source>
        <translation>Pour la recherche seulement : pas pour guider une aiguille.</translation>
    </message>
</context>
</TS>
